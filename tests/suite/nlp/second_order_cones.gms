* Second-order cones as people write them: optimal, whatever the start, and also where all squares of a row are 0.
* The Fermat point of a triangle: the sum of the distances is sqrt(25 + 24 sin(60)).
positive variable a, b, c;  variable x, y, z;
equation total, far, up, origin;
total..  z =e= a + b + c;
far..    sqr(a) =g= sqr(x - 4) + sqr(y);
up..     sqr(b) =g= sqr(x) + sqr(y - 3);
origin.. sqr(c) =g= sqr(x) + sqr(y);
model fermat / all /;
solve fermat using qcp minimizing z;
*= fermat.modelstat 1
*= fermat.objval 6.7664325675
* At a heavy corner: the row is at its apex.
equation heavy;
heavy..  z =e= a + b + 10*c;
model corner / heavy, far, up, origin /;
solve corner using qcp minimizing z;
*= corner.modelstat 1
*= corner.objval 7
* The same with roots, from a start where they have no derivative.
equation rooted;
rooted.. z =e= sqrt(sqr(x - 4) + sqr(y)) + eDist(x, y - 3) + 10*sqrt(sqr(x) + sqr(y));
model roots / rooted /;
x.l = 4; y.l = 0;
solve roots using nlp minimizing z;
*= roots.modelstat 1
*= roots.objval 7
* A square row without slope at the point that other methods stop at.
positive variable t;  variable u, v;  equation cost, cone;
cost..  v =e= -u + 0.1*t;
cone..  sqr(t) =g= sqr(u);
model apex / cost, cone /;
t.up = 1;
solve apex using qcp minimizing v;
*= apex.modelstat 1
*= apex.objval -0.9
* The side is not below 0 by another row; products on both sides; a row written out.
variable s, p, q;  positive variable r;  equation side, product, written, value;
side..     s =e= 2*r + 1;
product..  s*r =g= sqr(p - 2) + 1;
written..  sqr(r) =g= sqr(q) - 6*q + 9 + p*p;
value..    v =e= s + q + r;
model mixed / side, product, written, value /;
solve mixed using qcp minimizing v;
*= mixed.modelstat 1
* Not convex: the side may have either sign.
variable w;  equation freely, line;
freely..  sqr(w) =g= sqr(u - 1) + 1;
line..  v =e= u + w;
model either / freely, line /;
u.lo = -2; u.up = 2; w.lo = -9; w.up = 9; w.l = -3;
solve either using qcp minimizing v;
*= either.modelstat 2
* A ray: nothing holds it; and a contradiction.
variable h;  equation gain, ice, bound;
gain..  v =e= -h + 0.5*r;
ice..   sqr(r) =g= sqr(h) + sqr(p);
bound.. h =g= r + 1;
model open / gain, ice /;
solve open using qcp minimizing v;
*= open.modelstat 3
model none / gain, ice, bound /;
solve none using qcp minimizing v;
*= none.modelstat 4
* A real power has no value below 0, so that its bound counts.
variable k;  equation power;
power..  v =e= (k - 1)**2 + k;
model real / power /;
k.lo = 1; k.up = 5; k.l = 3;
solve real using nlp minimizing v;
*= real.modelstat 1
*= real.objval 1
