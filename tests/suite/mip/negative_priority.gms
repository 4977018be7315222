* Negative priorities are priorities like others: what has the least is branched on first.
integer variables p, q;
free variable z;
p.up = 5;
q.up = 5;
p.prior = -2;
equations e, f, g;
e..  z =e= p + 2*q;
f..  2*p + 2*q =g= 3;
g..  3*p + 5*q =g= 7;
model m / all /;
m.priorOpt = 1;
m.optCR = 0;
solve m using mip minimizing z;
*= m.modelstat 1
*= z.l 3
