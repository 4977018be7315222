* bmod only: a Euclidean distance is convex, so that a location model is searched by tangents and its answer is proved;
* before, each node was a nonlinear program with kinks (39 s of processor time, model status 8). Every split of the
* customers was solved by Weiszfeld's method as well: 28.4125454.
set c / 1*10 /, w / a, b /, k / x, y /;
table p(c,k)
      x   y
 1    1   2
 2    2   8
 3    9   1
 4    8   7
 5    5   5
 6    3   4
 7    7   2
 8    6   9
 9    0   6
10    9   9;
scalar big / 20 /;
positive variables s(w,k), d(c,w);  binary variable y(c,w);  variable z;
s.up(w,k) = 10;  d.up(c,w) = big;
equations total, dist(c,w), one(c), room(w);
total..      z =e= sum((c,w), d(c,w));
dist(c,w)..  d(c,w) =g= sqrt(sum(k, sqr(s(w,k) - p(c,k)))) - big*(1 - y(c,w));
one(c)..     sum(w, y(c,w)) =e= 1;
room(w)..    sum(c, y(c,w)) =l= 6;
model m / all /;
option optCR = 0, resLim = 300;
solve m using minlp minimizing z;
scalar status, least;
status = m.modelStat;  least = round(z.l, 5);
*= status 1
*= least 28.41255
