* bmod only: a convex quadratic program whose terms are of very different sizes: solved with a finer tolerance, not by another method
option without = sequential_quadratic;
set t / 0*10 /, r / r1*r8 /;
parameter area(r), value(r);
option seed = 3;
area(r) = uniform(1,30);  value(r) = uniform(0,3);
positive variables land(t,r), plant(t,r), cut(t,r);
variables stock(t,r), work(t), gain;
equations moves(t,r), grows(t,r), works(t), total;
moves(t,r)$(ord(t) < card(t))..  land(t+1,r) - land(t,r) =e= plant(t,r) - cut(t,r);
grows(t,r)$(ord(t) < card(t))..  stock(t+1,r) - stock(t,r) =e= -500*plant(t,r) - 0.05*stock(t,r) + 25*(area(r) - land(t,r));
works(t)$(ord(t) < card(t))..  work(t) =e= sum(r, plant(t,r) + cut(t,r));
total..  gain =e= sum(t$(ord(t) < card(t)), exp(-0.02*(ord(t) - 1))
  *(-20*sum(r, 2*land(t,r) - (stock(t+1,r) - stock(t,r))) + 45*sum(r, value(r)*land(t,r)) - 83*sqr(work(t))));
land.up(t,r) = area(r);
land.fx('0',r) = area(r)*sqr(uniform(0,0.7));  stock.fx('0',r) = 500*(area(r) - land.l('0',r));
plant.fx('10',r) = 0;  cut.fx('10',r) = 0;  work.fx('10') = 0;
model m / all /;
solve m using qcp maximizing gain;
scalar few;  few = m.iterusd < 31;
*= m.modelstat 1
*= gain.l 69436.96642
*= few 1
