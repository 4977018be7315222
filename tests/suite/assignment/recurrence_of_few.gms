* Where each element reads what those before it have written, what lies before the first record of the symbol is not seen
* before the end; what comes behind it is, and what has become 0 is 0.
set t / 1*5 /, i / u, v /;  parameter a(t), b(t), c(t), d(t), e(t), f(i,t), g(t);
a('3') = 7;  a('5') = 2;  b(t) = a(t);  c(t) = a(t);  d(t) = a(t);  e(t) = a(t);  f(i,t) = a(t);
a(t+1) = 10*a(t-1) + 1;
b(t-1) = 10*b(t-2) + 1;
c(t++2) = 10*c(t++1) + 1;
d(t--1) = -d(t++1);
e(t--2) = 10*e(t++2) + 1;
f(i,t+1) = 10*f(i,t-1) + 1;
g('1') = 6;  g(t++1) = -g(t-1);
option decimals = 0;  display a, b, c, d, e, f, g;
*> ----     12 PARAMETER a
*>
*> 2  1,    3  1,    4  1,    5 11
*>
*> ----     12 PARAMETER b
*>
*> 1  1,    2  1,    3  1,    4 11,    5  2
*>
*> ----     12 PARAMETER c
*>
*> 1 1111,    2    1,    3    1,    4   11,    5  111
*>
*> ----     12 PARAMETER d
*>
*> 1 -7
*>
*> ----     12 PARAMETER e
*>
*> 1 7111,    2    1,    3    1,    4   71,    5  711
*>
*> ----     12 PARAMETER f
*>
*>             2           3           4           5
*>
*> u           1           1          11          11
*> v           1           1          11          11
*>
*> ----     12 PARAMETER g
*>
*> 3 -6,    5  6
