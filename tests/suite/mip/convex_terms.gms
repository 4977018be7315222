* bmod only: terms that the rules of composition know to be convex are searched by tangents, and the answer is proved.
* GAMS's SBB gives the same values (the batch plant is that of Kocis & Grossmann 1988, published: 285506.5), and says 8.
set i / A, B, C, D, E /, j / 1*6 /, k / 1*4 /;
parameter q(i) / A 250000, B 150000, C 180000, D 160000, E 120000 /;
table s(i, j)
       1    2    3    4    5    6
  A  7.9  2.0  5.2  4.9  6.1  4.2
  B  0.7  0.8  0.9  3.4  2.1  2.5
  C  0.7  2.6  1.6  3.6  3.2  2.9
  D  4.7  2.3  1.6  2.7  1.2  2.5
  E  1.2  3.6  2.4  4.5  1.6  2.1;
table t(i, j)
       1    2    3    4    5    6
  A  6.4  4.7  8.3  3.9  2.1  1.2
  B  6.8  6.4  6.5  4.4  2.3  3.2
  C  1.0  6.3  5.4 11.9  5.7  6.2
  D  3.2  3.0  3.5  3.3  2.8  3.4
  E  2.1  2.5  4.2  3.6  3.7  2.2;
variables v(j), b(i), tl(i), n(j), cost;
binary variable y(k, j);
equations volume(i, j), cycle(i, j), horizon, units(j), one(j), total;
volume(i, j)..  v(j) =g= log(s(i, j)) + b(i);
cycle(i, j)..   n(j) + tl(i) =g= log(t(i, j));
horizon..       sum(i, q(i)*exp(tl(i) - b(i))) =l= 6000;
units(j)..      n(j) =e= sum(k, log(ord(k))*y(k, j));
one(j)..        sum(k, y(k, j)) =e= 1;
total..         cost =e= sum(j, 250*exp(n(j) + 0.6*v(j)));
v.lo(j) = log(300);  v.up(j) = log(3000);
n.lo(j) = 0;         n.up(j) = log(4);
tl.lo(i) = smax(j, log(t(i, j)/4));                tl.up(i) = smax(j, log(t(i, j)));
b.lo(i) = log(q(i)*smax(j, t(i, j)/4)/6000);       b.up(i) = min(log(q(i)), smin(j, log(3000/s(i, j))));
model batch / volume, cycle, horizon, units, one, total /;
option optCR = 0;
solve batch using minlp minimizing cost;
*= batch.modelstat 1
*= cost.l 285506.5082

* equations that may be relaxed: more of a2 and a3 than needed only costs
positive variables a2, a3, b2, b3, bp, b1, c1;
binary variables y1, y2, y3;
variable profit;
equations make, two, three, balance, l1, l2, l3, gain;
make..     c1 =e= 0.9*b1;
two..      exp(b2) - 1 =e= a2;
three..    exp(b3/1.2) - 1 =e= a3;
balance..  b1 =e= b2 + b3 + bp;
l1..       c1 =l= 2*y1;
l2..       b2 =l= 4*y2;
l3..       b3 =l= 5*y3;
gain..     profit =e= 11*c1 - 3.5*y1 - y2 - 1.5*y3 - b2 - 1.2*b3 - 1.8*(a2 + a3) - 7*bp;
c1.up = 1;  b2.up = 4;  b3.up = 5;
model process / make, two, three, balance, l1, l2, l3, gain /;
solve process using minlp maximizing profit;
scalar best, short;
best = profit.l;
short = abs(exp(b2.l) - 1 - a2.l) + abs(exp(b3.l/1.2) - 1 - a3.l);
*= process.modelstat 1
*= best 1.923098738
*= short 0

* no convex program where the same equation pays
equation gift;
gift..     profit =e= 11*c1 - 3.5*y1 - y2 - 1.5*y3 - b2 - 1.2*b3 + 0.1*(a2 + a3) - 7*bp;
model other / make, two, three, balance, l1, l2, l3, gift /;
solve other using minlp maximizing profit;
*= other.modelstat 8
