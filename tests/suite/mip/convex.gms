* bmod only: a convex quadratic program with integers is solved for certain, others are not shown to be
integer variables x, y;
free variable z;
x.up = 5;
y.up = 5;
equations e, n;
e..  z =e= sqr(x - 1.3) + sqr(y - 2.2);
n..  z =e= sqr(x - 1.3) - sqr(y - 2.2) + x*y;
model convex / e /, not_convex / n /;
option optCR = 0;
solve convex using miqcp minimizing z;
scalar first;
first = z.l;
*= convex.modelstat 1
*= first 0.13
solve not_convex using minlp minimizing z;
*= not_convex.modelstat 8
