* Lags of the same index on both sides: each element sees what those before it have got. With any other
* reference the values are those from before.
set t / t1*t6 /, i / u, v /;  alias(t,s);  parameter a(t), b(i,t), c(t), d(t), e(t);
a(t) = ord(t);  a(t+1) = 10 + a(t-1);
b(i,t) = ord(t) + 10*ord(i);  b(i,t+1) = 100 + b(i,t-1);
c(t) = ord(t);  c(t+1) = 100*c(t) + c(t-1);
d(t) = ord(t);  d(t+1) = 10 + sum(s$(ord(s) = ord(t)), d(s-1));
e(t) = ord(t);  e(t++1) = 10 + e(t--1);
display a, b, c, d, e;
set on(t) / t1 /;  on(t+1) = on(t-1);  display on;
variable x(t);  x.l(t) = ord(t);  x.l(t+1)$(x.l(t-1) < 12) = x.l(t-1) + 10;  display x.l;
*> ----      9 PARAMETER a
*>
*> t1  1.000,    t2 10.000,    t3 11.000,    t4 20.000,    t5 21.000,    t6 30.000
*>
*> ----      9 PARAMETER b
*>
*>            t1          t2          t3          t4          t5          t6
*>
*> u      11.000     100.000     111.000     200.000     211.000     300.000
*> v      21.000     100.000     121.000     200.000     221.000     300.000
*>
*> ----      9 PARAMETER c
*>
*> t1   1.000,    t2 100.000,    t3 201.000,    t4 302.000,    t5 403.000,    t6 504.000
*>
*> ----      9 PARAMETER d
*>
*> t1  1.000,    t2 10.000,    t3 11.000,    t4 12.000,    t5 13.000,    t6 14.000
*>
*> ----      9 PARAMETER e
*>
*> t1 31.000,    t2 16.000,    t3 11.000,    t4 26.000,    t5 21.000,    t6 36.000
*>
*> ----     10 SET on
*>
*> t1,    t3,    t5
*>
*> ----     11 VARIABLE x.L
*>
*> t1  1.000,    t2 10.000,    t3 11.000,    t4 20.000,    t5 21.000,    t6  6.000
