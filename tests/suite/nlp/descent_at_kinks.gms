* Where pieces meet, no column alone leads down, but a straight line does: the search goes on along it.
variables x, y, f;
equations o, p, q, r;
x.lo = -3;  x.up = 3;  y.lo = -3;  y.up = 3;
o..  f =e= max(x, y - 2*x) + x - max(0, y - 1);
model across / o /;
solve across using dnlp minimizing f;
scalar first;  first = f.l;
*= across.modelStat 2
*= first -2

* one kink inside another, and a kink inside a square
p..  f =e= sqr(max(x, min(y, 0))) - abs(x) - abs(y - x);
x.l = 0;  y.l = 0;
model nested / p /;
solve nested using dnlp minimizing f;
scalar second;  second = f.l;
*= nested.modelStat 2
* pieces that meet in a row
q..  f =e= sqr(x - 1) + sqr(y - 2);
r..  max(x, y) =e= min(1, abs(x));
x.l = 0;  y.l = 0;
model in_a_row / q, r /;
solve in_a_row using dnlp minimizing f;
scalar missed;  missed = abs(max(x.l, y.l) - min(1, abs(x.l)));
*= in_a_row.modelStat 2
*= missed 0

* concave pieces without a bound below
x.lo = -inf;  x.up = inf;  x.l = 0;  y.l = 0;
equation s;  s..  f =e= -abs(x) - abs(y);
model falls / s /;
solve falls using dnlp minimizing f;
*= falls.modelStat 3
