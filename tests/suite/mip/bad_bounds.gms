* Bounds of a discrete variable that leave nothing to it.
integer variable x;
free variable z;
equation e;
e.. z =e= x;
x.lo = 0.2;
x.up = 0.8;
model m / all /;
solve m using mip minimizing z;
*! execution 9
