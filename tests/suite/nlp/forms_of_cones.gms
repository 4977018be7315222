* Convex programs in the forms that are recognised as cones: one small model each, all optimal (docs/nlp.md has the table).
set i / 1*3 /;  alias (i, j);
parameter a(i) / 1 1, 2 4, 3 2 /;
positive variables s, t, u(i);  variables x(i), y, v, w;
x.lo(i) = -10;  x.up(i) = 10;  y.lo = -10;  y.up = 10;  u.up(i) = 10;  u.l(i) = 1;

* a square above squares: the distance of (1, 4, 2) from the plane x1 + x2 + x3 = 1 is 6/sqrt(3)
equations length, plane;
length..  sqr(t) =g= sum(i, sqr(x(i) - a(i)));
plane..   sum(i, x(i)) =e= 1;
equation far;  far..  v =e= t;
model squares / length, plane, far /;
solve squares using qcp minimizing v;
*= squares.modelstat 1
*= squares.objval 3.46410161514

* the root of a sum of squares with a constant: sqrt(12 + 4)
equation root;
root..  v =g= sqrt(sum(i, sqr(x(i) - a(i))) + 4);
model roots / root, plane /;
solve roots using nlp minimizing v;
*= roots.modelstat 1
*= roots.objval 4

* eDist: the way over a river at y between the points (0, -1) and (4, 2) is straight
equation way;
way..  v =e= eDist(y, 1) + eDist(y - 4, 2);
model distances / way /;
solve distances using nlp minimizing v;
*= distances.modelstat 1
*= distances.objval 5

* a product above squares: s t >= 4 with s + t least
equations product, both;
product..  s*t =g= sqr(y) + 4;
both..     v =e= s + t;
model products / product, both /;
solve products using qcp minimizing v;
*= products.modelstat 1
*= products.objval 4

* a convex quadratic row with products: y*y + y*w + w*w <= 3 with y + w largest
equations ellipse, ends;
ellipse..  sqr(y) + y*w + sqr(w) =l= 3;
ends..     v =e= -y - w;
model quadratic / ellipse, ends /;
solve quadratic using qcp minimizing v;
*= quadratic.modelstat 1
*= quadratic.objval -2

* a square over a variable: sqr(3 - s)/s + s, least where (3 - s)/s = sqrt(2) - 1
equation ratio;
ratio..  v =e= sqr(3 - s)/s + s;
model ratios / ratio /;
s.lo = 0.01;  s.l = 1;
solve ratios using nlp minimizing v;
*= ratios.modelstat 1
*= ratios.objval 2.48528137424

s.lo = 0;

* exponentials: exp(y) - 2 y, least at log(2)
equation grows;
grows..  v =e= exp(y) - 2*y;
model exponentials / grows /;
solve exponentials using nlp minimizing v;
*= exponentials.modelstat 1
*= exponentials.objval 0.613705638880

* their perspective: s*exp(y/s) with y >= 1 and s free to choose ends at y/s = 1
equation perspective;
perspective..  v =e= s*exp(y/s);
model perspectives / perspective /;
y.lo = 1;  y.l = 1;
solve perspectives using nlp minimizing v;
*= perspectives.modelstat 1
*= perspectives.objval 2.71828182846
y.lo = -10;  y.l = 0;

* relative entropy: shares nearest to 1, 4, 2 are 1/7, 4/7, 2/7, at -log(7)
equations relative, whole;
relative..  v =e= sum(i, u(i)*log(u(i)/a(i)));
whole..     sum(i, u(i)) =e= 1;
u.lo(i) = 1e-6;
model shares / relative, whole /;
solve shares using nlp minimizing v;
*= shares.modelstat 1
*= shares.objval -1.94591014906

* the same of two variables: s log(s/t) + t with s >= 1 is least where t = s = 1
equation cross;
cross..  v =e= s*log(s/t) + t;
model crossed / cross /;
s.lo = 1;  t.lo = 0.1;  t.l = 3;
solve crossed using nlp minimizing v;
*= crossed.modelstat 1
*= crossed.objval 1
s.lo = 0;  t.lo = 0;

* entropy, as a function: the largest is log(3)
equation disorder;
disorder..  v =e= sum(i, entropy(u(i)));
model disordered / disorder, whole /;
solve disordered using nlp maximizing v;
*= disordered.modelstat 1
*= disordered.objval 1.09861228867

* logarithms: a product of shares is largest where they are equal
equation logs;
logs..  v =e= sum(i, log(u(i)));
model logarithms / logs, whole /;
solve logarithms using nlp maximizing v;
*= logarithms.modelstat 1
*= logarithms.objval -3.29583686600

* powers: s**1.5 + 1/s
equation powers;
powers..  v =e= s**1.5 + s**(-1);
model powered / powers /;
solve powered using nlp minimizing v;
*= powered.modelstat 1
*= powered.objval 1.96013172427

* a weighted geometric mean: 3 s + t with s**0.25 t**0.75 >= 2
equations mean, cost;
mean..  s**0.25 * t**0.75 =g= abs(w) + 2;
cost..  v =e= 3*s + t;
model means / mean, cost /;
t.lo = 0.01;  t.l = 1;
solve means using dnlp minimizing v;
*= means.modelstat 1
*= means.objval 4.61880215352

* the logarithm of a sum of exponentials: log(exp(y) + exp(-y)), also as a function
equations soft, softer;
soft..    v =e= log(exp(y) + exp(-y));
softer..  v =e= lseMax(y, -y);
model sums / soft /, functions / softer /;
y.l = 3;
solve sums using nlp minimizing v;
*= sums.modelstat 1
*= sums.objval 0.693147180560
y.l = 3;
solve functions using nlp minimizing v;
*= functions.modelstat 1
*= functions.objval 0.693147180560
