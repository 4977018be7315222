* Convex quadratic programs, solved by tangents: blocks of columns, some switched by a binary, integer columns, a quadratic row.
* GAMS's SBB gives the same values, and says 8.
set i /1*10/, j /1*12/, k(i) /1*9/;
alias(k, kk);
parameter f(i), c(i, j), w(k), goal(k), s(i), mu(i);
f(i) = 20 + mod(ord(i)*7, 13);
c(i, j) = 2 + mod(ord(i)*5 + ord(j)*11, 17);
w(k) = 0.5 + 0.1*ord(k);
goal(k) = 3.3 + mod(ord(k)*4, 9)*1.37;
s(i) = 0.1 + 0.02*mod(ord(i)*7, 11);
mu(i) = 0.05 + 0.012*mod(ord(i)*5, 13);
positive variables x(i, j), p(i);
binary variable y(i);
integer variable n(k);
free variable z;
n.up(k) = 15;
equations cost, served(j), open(i, j), far, some, most, earned, whole, few, atleast(i), room(i), risk;
cost..  z =e= sum(i, f(i)*y(i)) + sum((i, j), c(i, j)*x(i, j) + 3*sqr(x(i, j)));
served(j)..  sum(i, x(i, j)) =e= 1;
open(i, j)..  x(i, j) =l= y(i);
far..  z =e= sum(k, w(k)*sqr(n(k) - goal(k))) + 0.05*sqr(sum(k, n(k)*(1 - 2*mod(ord(k), 2)))) + 0.3*sqr(sum(k, w(k)*n(k)) - 40);
some..  sum(k, n(k)) =l= 60;
most..  sum(k, ord(k)*n(k)) =g= 250;
earned..  z =e= sum(i, mu(i)*p(i)) - 0.004*sum(i, y(i));
whole..  sum(i, p(i)) =e= 1;
few..  sum(i, y(i)) =l= 5;
atleast(i)..  p(i) =g= 0.05*y(i);
room(i)..  p(i) =l= 0.35*y(i);
risk..  sum(i, sqr(s(i)*p(i))) + 0.3*sqr(sum(i, 0.1*s(i)*p(i))) =l= 0.007;
model sites / cost, served, open /, lots / far, some, most /, shares / earned, whole, few, atleast, room, risk /;
option optCR = 0;
solve sites using miqcp minimizing z;
*= sites.modelstat 1
*= sites.objval 148
solve lots using miqcp minimizing z;
*= lots.modelstat 1
*= lots.objval 122.6977
solve shares using miqcp maximizing z;
*= shares.modelstat 1

* Units with quadratic costs of fuel: the perspective of a square is what makes their bound worth something.
set unit /1*8/, t /1*18/;
parameters top(unit), base(unit), slope(unit), curve(unit), start(unit), load(t);
top(unit) = 80 + 35*mod(ord(unit)*3, 7);
base(unit) = 100 + 40*mod(ord(unit), 5);
slope(unit) = 14 + mod(ord(unit)*5, 9)*0.7;
curve(unit) = 0.003 + 0.001*mod(ord(unit)*2, 5);
start(unit) = 150 + 60*mod(ord(unit)*3, 4);
load(t) = 620 + 260*sin(ord(t)*0.35) + 40*mod(ord(t), 3);
binary variables on(unit, t), up(unit, t);
positive variable output(unit, t);
equations fuel, met(t), spare(t), lowest(unit, t), highest(unit, t), started(unit, t), once(unit, t);
fuel..  z =e= sum((unit, t), base(unit)*on(unit, t) + slope(unit)*output(unit, t) + curve(unit)*sqr(output(unit, t)) + start(unit)*up(unit, t));
met(t)..  sum(unit, output(unit, t)) =e= load(t);
spare(t)..  sum(unit, top(unit)*on(unit, t)) =g= 1.08*load(t);
lowest(unit, t)..  output(unit, t) =g= 0.3*top(unit)*on(unit, t);
highest(unit, t)..  output(unit, t) =l= top(unit)*on(unit, t);
started(unit, t)..  up(unit, t) =g= on(unit, t) - on(unit, t-1);
once(unit, t)$(ord(t) > 2)..  up(unit, t-1) + up(unit, t) =l= on(unit, t);
model commit / fuel, met, spare, lowest, highest, started, once /;
solve commit using miqcp minimizing z;
*= commit.modelstat 1
*= commit.objval 211829.411616
