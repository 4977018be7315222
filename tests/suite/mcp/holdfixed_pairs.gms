* A pair whose variable is held fixed is none: the row has no marginal, and the column none of its own.
set i / a, b, c /;  positive variable x(i);  equation f(i);
f(i).. 3*x(i) + sum(i.local, x(i)) =g= 4 + ord(i);
x.fx('b') = 0.75;  model m / f.x /;  m.holdFixed = 1;
solve m using mcp;
option decimals = 5;  display x.l, x.m, f.l, f.m, f.lo, m.numVar;
*> ----      6 VARIABLE x.L
*>
*> a 0.71667,    b 0.75000,    c 1.38333
*>
*> ----      6 VARIABLE x.M
*>
*>                       ( ALL     0.00000 )
*>
*> ----      6 EQUATION f.L
*>
*> a 4.25000,    b 2.10000,    c 6.25000
*>
*> ----      6 EQUATION f.M
*>
*> a 0.71667,    c 1.38333
*>
*> ----      6 EQUATION f.Lo
*>
*> a 4.25000,    b 3.00000,    c 6.25000
*>
*> ----      6 MODEL m.NumVar                 =      2.00000
