* bmod only: second-order cones are convex, and the answer is proved. GAMS's SBB says 8.
set i / 1*5 /, c / x, y /;
table p(i, c)
      x   y
  1   1   6
  2   9   2
  3   4   9
  4  -7  -8
  5   6   5;
parameter a(i) / 1 3, 2 1, 3 2, 4 5, 5 4 /;
binary variables b(i);
integer variables n, k;
positive variables d(i), q(c), v(i), s(i), t, r;
variables at(c), w(i), z;
equations near, reach(i), some, side, cover, pay, total, on(i), fill, tall, hyperbola, shift, cone, other, hole, tip, ball;
* three of five places, from the best point
near..  z =e= sum(i, w(i));
reach(i)..  sqr(d(i)) =g= sum(c, sqr(at(c) - p(i, c)));
cover(i)..  w(i) =g= d(i) - 40*(1 - b(i));
some..  sum(i, b(i)) =e= 3;
side(i)..  w(i) =g= 0;
* squares over what is switched on
pay..  z =e= sum(i, a(i)*v(i)) + 3*sum(i, b(i));
total..  sum(i, s(i)) =e= 4;
on(i)..  v(i)*b(i) =g= sqr(s(i));
fill(i)..  v(i) =l= 16;
tall..  z =e= 2*n + 3*t;
hyperbola..  n*t =g= 5;
shift..  z =e= 2*t - k;
cone..  sqr(k) + 1 =l= sqr(t);
* no cones: 1 is too much, and t may be negative
other..  sqr(k) =l= sqr(t) + 1;
hole..  sqr(r) =l= sqr(w('1'));
* a cone of many columns: its relaxation is solved as a conic program, which proves it
tip..  z =e= t - 2*at('x') + k;
ball..  sqr(t) =g= sum(c, sqr(at(c))) + sum(i, sqr(s(i) - b(i)));
model places / near, reach, cover, some, side /, costs / pay, total, on, fill /, slopes / tall, hyperbola /, shifts / shift, cone /;
model lacks / shift, other, hole /, tips / tip, ball /;
option optCR = 0;
n.lo = 1;
solve places using miqcp minimizing z;
*= places.modelstat 1
*= places.objval 7.9483906885
solve costs using miqcp minimizing z;
* where v and s are 0 the row has no slope: it holds to 5e-8 of its terms
scalar cost;
cost = round(costs.objval, 5);
*= costs.modelstat 1
*= cost 16.66667
solve slopes using minlp minimizing z;
*= slopes.modelstat 1
*= slopes.objval 11
solve shifts using miqcp minimizing z;
*= shifts.modelstat 1
*= shifts.objval 1.8284271247
r.fx = 2;
w.lo('1') = -3;
w.up('1') = 9;
k.up = 5;
solve lacks using miqcp minimizing z;
*= lacks.modelstat 8
at.up(c) = 3;
solve tips using miqcp minimizing z;
*= tips.modelstat 1
