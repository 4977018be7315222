* bmod only: a convex quadratic program with integers is solved for certain, others are not shown to be
integer variables x, y;
positive variable v;
free variable z;
x.up = 5;
y.up = 5;
v.up = 5;
equations e, n;
e..  z =e= sqr(x - 1.3) + sqr(y - 2.2);
n..  z =e= sqr(x - 1.3) - sqr(v - 2.2) + x*y*v;
model convex / e /, not_convex / n /;
option optCR = 0;
solve convex using miqcp minimizing z;
scalar first;
first = z.l;
*= convex.modelstat 1
*= first 0.13
solve not_convex using minlp minimizing z;
*= not_convex.modelstat 8

* a convex quadratic row: with another right side no integers satisfy it
scalar room / 0.6 /;
equations s, near;
s..  z =e= x + y;
near..  sqr(x - 1.5) + sqr(y - 1.5) =l= room;
model disc / s, near /;
solve disc using miqcp minimizing z;
scalar second;
second = disc.modelstat;
*= second 1
*= disc.objest na
room = 0.4;
solve disc using miqcp minimizing z;
*= disc.modelstat 10
*? why near
*? why x is discrete
