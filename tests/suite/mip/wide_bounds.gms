* A row is not implied because its variables have wide bounds.
integer variable x;
positive variable y;
free variable z;
equations o, c;
x.up = 1e9;
y.up = 1e9;
o..  z =e= 3*x + 5*y;
c..  x + y =g= 0.75;
model m / all /;
m.optCR = 0;
solve m using mip minimizing z;
*= m.modelstat 1
*= z.l 3
