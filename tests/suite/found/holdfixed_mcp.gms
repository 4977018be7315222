* `holdFixed` in an `mcp`.
set i / i1*i2 /; positive variable x(i); equation f(i); x.fx('i1') = 1.25;
f(i).. 2*x(i) + 0.5*sum(i.local, x(i)) =g= 3;
model m / f.x /; m.holdfixed = 1; solve m using mcp;
display x.m, f.m, m.numvar;
*> ----      5 VARIABLE x.M
*>
*>                       ( ALL       0.000 )
*>
*> ----      5 EQUATION f.M
*>
*> i2 0.950
*>
*> ----      5 MODEL m.NumVar                 =        1.000
