* A row with a large coefficient: b = 0.0000005 satisfies it and is an integer to the usual tolerance of 1e-6, so that a solver may claim 0.0005.
binary variable b;
positive variables x, y;
free variable z;
x.up = 1e7;
y.up = 100;
equations need, link, cost;
need..  x + y =g= 5;
link..  x =l= 1e7*b;
cost..  z =e= 1000*b + 300*y;
model m / all /;
m.optCR = 0;
solve m using mip minimizing z;
*= m.modelstat 1
*= z.l 1000
*= b.l 1
*? width 1e-12
