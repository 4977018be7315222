* Bins, lines and teams that are alike: what permutations make of a solution is not looked at again.
set i /1*15/, m(i) /1*12/, b /b1*b7/, k /k1*k5/, t /t1*t4/;
parameter w(i) / 1 34, 2 51, 3 27, 4 48, 5 39, 6 22, 7 57, 8 31, 9 44, 10 29, 11 53, 12 36, 13 25, 14 41, 15 46 /;
binary variables x(i, b), u(b), l(k), a(i, t);
positive variables f(k), y;
variable z;
equations one(i), room(b), bins, flow, most(k), lines, team(i), load(t), span;
one(i)..  sum(b, x(i, b)) =e= 1;
room(b)..  sum(i, w(i)*x(i, b)) =l= 100*u(b);
bins..  z =e= sum(b, u(b));
* Lines of one corridor, each in both directions: l is given twice, by an equation of two columns.
binary variable back(k);
equation both(k);
both(k)..  l(k) =e= back(k);
flow..  sum(k, f(k)) =e= 31;
most(k)..  f(k) =l= 5*l(k) + 4*back(k);
lines..  z =e= sum(k, 3*l(k) + 2*back(k)) + 0.1*sum(k, f(k));
team(m)..  sum(t, a(m, t)) =e= 1;
load(t)..  sum(m, w(m)*a(m, t)) =l= y;
span..  z =e= y;
model pack / one, room, bins /, grid / both, flow, most, lines /, share / team, load, span /;
option optCR = 0;
solve pack using mip minimizing z;
*= pack.modelstat 1
*= pack.objval 6
solve grid using mip minimizing z;
*= grid.modelstat 1
*= grid.objval 23.1
scalar apart;
apart = sum(k, abs(l.l(k) - back.l(k)));
*= apart 0
solve share using mip minimizing z;
*= share.modelstat 1
*= share.objval 118
* 721 nodes, 500 of them before orbits come in; without orbits 1976.
abort$(share.nodusd > 1200) 'permutations of a solution are looked at again';
