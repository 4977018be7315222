* bmod only: jobs of which one comes before the other, by a large number. The relaxation knows nothing of it; that what comes
* before a job takes its time gives a bound of 235 at the root (24 without it, and 130 000 nodes; HiGHS 1.16 gives 240 as well).
set j / j1*j11 /;
alias (j, k);
set pair(j,k);
pair(j,k) = ord(k) < ord(j);
parameter p(j) 'time' / j1 8, j2 9, j3 8, j4 8, j5 9, j6 10, j7 4, j8 3, j9 9, j10 8, j11 11 /,
  due(j) / j1 41, j2 52, j3 13, j4 8, j5 30, j6 21, j7 11, j8 7, j9 36, j10 53, j11 58 /,
  w(j) 'weight' / j1 1, j2 7, j3 8, j4 3, j5 1, j6 9, j7 2, j8 1, j9 1, j10 4, j11 4 /;
scalar big;
big = sum(j, p(j));
binary variable y(j,k) 'j is before k';
positive variables s(j) 'start', late(j);
variable cost;
s.up(j) = big;
equations total, tardy(j), after(j,k), before(j,k);
total..                cost =e= sum(j, w(j)*late(j));
tardy(j)..             late(j) =g= s(j) + p(j) - due(j);
after(pair(j,k))..     s(j) =g= s(k) + p(k) - big*y(j,k);
before(pair(j,k))..    s(k) =g= s(j) + p(j) - big*(1 - y(j,k));
model m / all /;
m.optCR = 0;
option mip = bmip;
solve m using mip minimizing cost;
scalar few 'nodes';
few = m.nodUsd < 1000;
*= m.modelstat 1
*= cost.l 240
*= few 1
