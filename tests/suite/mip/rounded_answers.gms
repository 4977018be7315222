* bmod only: programs built from the rounded answer of a first are optimal if a point misses no row by more than the tolerance
set i /a, b, c/;
parameter d(i) /a 1, b 2, c 3.5/, known(i), off, statuses(*), value;
variables z, w;
positive variables x(i), y(i);
binary variable open(i);
equations cost, demand, room(i), second, same(i), dear, total;
cost..     z =e= sum(i, d(i)*x(i) + 0.3*open(i));
demand..   sum(i, x(i)) =e= 7/3;
room(i)..  x(i) =l= (1/3 + ord(i)/3)*open(i);
model first / cost, demand, room /;
first.optCR = 0;
solve first using mip minimizing z;
*= first.modelStat 1
*= z.l 5.9
known(i) = round(x.l(i), 7);
scalar best;  best = round(z.l, 7);
off = 0;
second..   w =e= sum(i, y(i)*ord(i)) + x('b') + open('c');
same(i)..  x(i) + y(i) =e= known(i);
dear..     sum(i, d(i)*(x(i) + y(i)) + 0.3*open(i)) =l= best;
total..      sum(i, x(i) + y(i)) =e= 7/3 + off;
model next / second, same, dear, total, room /;
next.optCR = 0;
solve next using mip maximizing w;
statuses('mip') = next.modelStat;  value = round(w.l, 5);
*= statuses('mip') 1
*= value 5.66667
solve next using rmip maximizing w;
statuses('rmip') = next.modelStat;
*= statuses('rmip') 1
* rounded beyond the tolerance
off = 1e-4;
solve next using mip maximizing w;
statuses('far') = next.modelStat;
*= statuses('far') 10
solve next using rmip maximizing w;
statuses('far, relaxed') = next.modelStat;
*= statuses('far, relaxed') 4
