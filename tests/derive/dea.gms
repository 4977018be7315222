$title Data envelopment: one small program per unit in a loop, the unit a dynamic set
sets u 'units' / u1*u8 /, i 'inputs' / staff, area /, o 'outputs' / sales, repeat /, slice(u);
alias (u,k);
table data(u,*)
     staff area sales repeat
u1    5     14   9     4
u2    8     15   5     7
u3    7     12   4     9
u4    4     10   6     3
u5    9     20   8     8
u6    3      9   3     2
u7    6     11   7     5
u8    8     16   9     6;
positive variables v(i), w(o), lambda(u); variable eff, theta;
equations defe(u), denom(u), lime(u), dinp(i,u), dout(o,u), convex;
defe(slice)..  eff =e= sum(o, w(o)*data(slice,o));
denom(slice).. sum(i, v(i)*data(slice,i)) =e= 1;
lime(u)..      sum(o, w(o)*data(u,o)) =l= sum(i, v(i)*data(u,i));
dinp(i,slice)..  sum(u, lambda(u)*data(u,i)) =l= theta*data(slice,i);
dout(o,slice)..  sum(u, lambda(u)*data(u,o)) =g= data(slice,o);
convex..         sum(u, lambda(u)) =e= 1;
model primal / defe, denom, lime /, dualm / dinp, dout, convex /;
v.lo(i) = 1e-4; w.lo(o) = 1e-4;
parameter score(u,*);
slice(u) = no;
loop(k,
  slice(k) = yes;
  solve primal using lp maximizing eff;
  score(k,'ccr') = eff.l;
  solve dualm using lp minimizing theta;
  score(k,'bcc') = theta.l;
  slice(k) = no;
);
display score;
slice('u3') = yes;
solve primal using lp maximizing eff;
