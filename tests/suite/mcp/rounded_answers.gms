* bmod only: conditions built from rounded answers hold if a point misses none of them by more than the tolerance
set i /a, b, c/;
parameter d(i) /a 1, b 2, c 3/, known(i), off, statuses(*);
known(i) = round(d(i)/3, 7);
positive variables p(i), w;
variable u(i);
equations price(i), need(i), cap;
off = 1e-7;
price(i)..  d(i) - u(i) + w =g= 0;
need(i)..   p(i) =e= d(i)/3;
cap..       2 - off =g= sum(i, p(i));
p.up(i) = known(i);
model m / price.p, need.u, cap.w /;
solve m using mcp;
statuses('near') = m.modelStat;
*= statuses('near') 1
off = 1e-3;
solve m using mcp;
statuses('far') = m.modelStat;
*= statuses('far') 4
