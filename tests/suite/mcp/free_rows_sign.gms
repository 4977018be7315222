* Where a variable is free, its row and the row with the other sign mean the same. Carriers on congested roads: the balances are
* written "in - out", which makes a saddle of what "out - in" makes monotone.
Set carrier / c1*c4 /, place / a*e /, road / 1*12 /;
Alias (carrier,other), (place,from,to,source,sink);
Set leads(road,place,place) / 1.a.b, 2.b.a, 3.b.c, 4.c.b, 5.c.d, 6.d.c, 7.d.e, 8.e.d, 9.e.a, 10.a.e, 11.b.d, 12.d.b /;
Parameters slope(road), toll(road), load(place);
slope(road) = 2 + 1.5*mod(ord(road),5);
toll(road)  = 5 + mod(3*ord(road),7);
Positive Variables flow(carrier,road), queue(road);
Variables value(carrier,place);
Equations best(carrier,road), room(road), balance(carrier,place);
best(carrier,road)..  slope(road)*(sum(other, flow(other,road)) + flow(carrier,road)) + toll(road) + queue(road)
  + sum(leads(road,from,to), value(carrier,to) - value(carrier,from)) =g= 0;
room(road)..  3.2 - sum(carrier, flow(carrier,road)) =g= 0;
balance(carrier,place)..  sum(leads(road,from,place), flow(carrier,road)) - sum(leads(road,place,to), flow(carrier,road)) =e= load(place);
Model m / best.flow, room.queue, balance.value /;
Scalars bad / 0 /, cost / 0 /;
loop((source,sink)$(not sameas(source,sink)),
  load(place) = 0;  load(source) = -1;  load(sink) = 1;
  flow.l(carrier,road) = 0.5;  queue.l(road) = 0.5;  value.l(carrier,place) = 0.5;
  solve m using mcp;
  bad = bad + (m.modelStat <> 1);
  cost = cost + sum((carrier,road), toll(road)*flow.l(carrier,road)) + sum(road, slope(road)*sqr(sum(carrier, flow.l(carrier,road))));
);
*= bad 0
