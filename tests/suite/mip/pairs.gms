* bmod only: a program with pairs and integers; the best found, not shown to be the best
set i / 1*2 /;
positive variable x(i);
integer variable n;
free variable z;
n.up = 3;
equations o, need, a(i);
a(i)..  x(i) =g= n - 0.5;
need..  n =g= 0.3;
o..     z =e= sum(i, x(i)) + 2*n;
model m / o, need, a.x /;
m.optCR = 0;
solve m using mpec minimizing z;
scalar least;
least = z.l;
*= m.modelstat 8
*= least 3
solve m using mpec maximizing z;
*= z.l 11
*= n.l 3
