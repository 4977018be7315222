* Pairs whose rows are linear, an objective that is not: where the bounded products lead to no point that satisfies all pairs,
* branching over the pieces finds one. Travellers choose the cheapest way; tolls are paid where a road is full.
set i / a, b, c, d /; alias (i,j);
set road(i,j) / a.(b,c), b.d, c.(b,d) /;
table data(i,j,*)
        time  slope  size
  a.b     50      1     3
  a.c      8      2     4
  b.d     12      2     6
  c.d     55      1     3
  c.b      9      1     1 ;
parameter net(i) 'leave minus arrive' / a 7, d -7 /;
variable z; positive variables x(i,j), toll(i,j), time(i), open(i,j);
open.up(road) = 1;
equations cost, flow(i), money, full(i,j), cheapest(i,j);
cost..            z =e= sum(road, data(road,'time')*x(road) + data(road,'slope')*sqr(x(road)));
flow(i)..         sum(road(i,j), x(road)) - sum(road(j,i), x(road)) =e= net(i);
money..           sum(road, open(road)) =l= 5;
full(road)..      data(road,'size')*open(road) - x(road) =g= 0;
cheapest(road(i,j)).. data(road,'time') + data(road,'slope')*x(road) + toll(road) + time(i) - time(j) =g= 0;
model roads / cost, money, flow.time, cheapest.x, full.toll /;
solve roads using mpec minimizing z;
*= roads.modelstat 2
*= roads.solvestat 1
*= z.l 487
*= x.l('a','b') 3
