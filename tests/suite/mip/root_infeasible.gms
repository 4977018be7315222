* The relaxation of a nonlinear program has no point, or none near the start: that is not due to whole numbers, and the status says so.
variables z, x;
binary variable b;
x.lo = -3;
x.up = 3;
equations o, none, far;
o..     z =e= x + b;
none..  sqr(sin(3*x)) + sqr(cos(2*x)) =g= 3 + b;
far..   power(x,4) - 8*sqr(x) + 3*x + b =l= -17;
x.l = 1;
model m / o, none /, n / o, far /;
solve m using minlp minimizing z;
*= m.modelstat 4
*= m.solvestat 1
x.lo = 0;
x.l = 2;
solve n using minlp minimizing z;
*= n.modelstat 5
