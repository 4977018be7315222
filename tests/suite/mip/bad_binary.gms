* A binary variable whose upper bound is 2.
binary variable b;
free variable z;
equation e;
e.. z =e= b;
b.up = 2;
model m / all /;
solve m using mip maximizing z;
*! execution 8
