* bmod only: programs built from the rounded answer of a first are optimal if a point misses no row by more than the tolerance
set i /a, b, c/;
parameter d(i) /a 1, b 2, c 3.5/, known(i), off, statuses(*);
variables z, w;
positive variables x(i), y(i);
equations cost, demand, product, second, same(i), dear, total;
cost..     z =e= sum(i, d(i)*sqr(x(i)));
demand..   sum(i, x(i)) =e= 7/3;
product..  x('a')*x('b') =l= 0.9;
x.l(i) = 1;
model first / cost, demand, product /;
solve first using nlp minimizing z;
*= first.modelStat 2
known(i) = round(x.l(i), 7);
scalar best;  best = round(z.l, 7) - 2e-7;
off = 0;
second..   w =e= sum(i, ord(i)*sqr(y(i))) + exp(x('b'));
same(i)..  x(i) + y(i) =e= known(i);
dear..     sum(i, d(i)*sqr(x(i) + y(i))) =l= best;
total..      sum(i, x(i) + y(i)) =e= 7/3 + off;
model next / second, same, dear, total /;
solve next using nlp minimizing w;
statuses('near') = next.modelStat;
*= statuses('near') 1
* nothing left to choose
x.fx(i) = known(i);  y.fx(i) = 0;
solve next using nlp minimizing w;
statuses('fixed') = next.modelStat;
*= statuses('fixed') 1
* rounded beyond the tolerance
x.lo(i) = 0;  x.up(i) = inf;  y.lo(i) = 0;  y.up(i) = inf;
off = 1e-4;
solve next using nlp minimizing w;
statuses('far') = next.modelStat;
*= statuses('far') 4
