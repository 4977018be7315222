* Semicontinuous and semi-integer variables, ordered sets, priorities that relax; the last index runs through a set.
set i / 1*3 /, k / a, b /;
semicont variable s;
semiint variable t;
sos1 variable u(i);
sos2 variable w(k,i);
integer variable x;
free variable z;
equations cost, need, share(k), part(k);
cost..      z =e= 2*s + 3*t + sum(i, ord(i)*u(i)) + sum((k,i), sqr(ord(i) - 2)*w(k,i)) + 2.5*x;
need..      s + t + 0.4*sum(i, u(i)) + 2*x =g= 2.5;
share(k)..  sum(i, w(k,i)) =e= 1;
part(k)..   sum(i, ord(i)*w(k,i)) =e= 1.75;
s.lo = 2;  s.up = 6;
t.lo = 3;  t.up = 7;
u.up(i) = 1;
x.up = 4;
model m / all /;
m.optCR = 0;
solve m using mip minimizing z;
scalars first, count;
first = z.l;
count = m.numdvar;
*= m.modelstat 1
*= first 5.5
*= count 3
x.prior = inf;
solve m using mip minimizing z;
*= z.l 3.625
*= x.l 1.25
*= w.l('a','1') 0.25
*= w.l('b','2') 0.75
*= w.l('a','3') 0
*= m.numdvar 2
