* Coefficients that are `eps` imply no bounds of integers.
integer variable x(*), y;  variable z, w;  set i / a, b /;
x.lo(i) = -4;  x.up(i) = 5;  y.lo = -3;  y.up = 6;  w.up = 8;
parameter a(i) / a eps, b 1 /;  scalar none / eps /;  equation e, f, o;
e.. sum(i, a(i)*x(i)) + none*y =l= 6.2;
f.. none*y =l= 3;
o.. z =e= w + 0.5*y + x('a') + 2*x('b');
model m / all /;  solve m using mip maximizing z;
display z.l, x.l, y.l, m.modelStat;
*> ----      9 VARIABLE z.L                   =       26.000
*>
*> ----      9 VARIABLE x.L
*>
*> a 5.000,    b 5.000
*>
*> ----      9 VARIABLE y.L                   =        6.000
*>             MODEL m.ModelStat              =        1.000
