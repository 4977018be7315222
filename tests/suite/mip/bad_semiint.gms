* The least value of a semi-integer variable is an integer.
semiint variable s;
free variable z;
equation e;
e.. z =e= s;
s.lo = 1.5;
s.up = 3;
model m / all /;
solve m using mip minimizing z;
*! execution 9
