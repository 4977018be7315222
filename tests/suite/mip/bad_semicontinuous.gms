* A semicontinuous variable whose bounds cross.
semicont variable s;
free variable z;
equation e;
e.. z =e= s;
s.lo = 5;
s.up = 3;
model m / all /;
solve m using mip minimizing z;
*! execution 9
