$title Lot sizes relaxed, with backlogs by double sums over periods; bounds of all kinds; free rows
set t / t1*t8 /, p / p1*p2 /; alias (t,s,u);
parameter d(p,t), bigm(p,t), hc(p,s,t);
d(p,t) = 3 + mod(3*ord(t)*ord(p), 7); bigm(p,t) = sum(s$(ord(s) >= ord(t)), d(p,s));
hc(p,s,t)$(ord(s) le ord(t)) = 0.4*(ord(t) - ord(s)) + 0.1*ord(p); hc(p,s,t)$(ord(s) gt ord(t)) = 1.5*(ord(s) - ord(t));
variables w(p,s,t), yv(p,t), cost, cumul(p,t); positive variable w; 
equations meet(p,t), setup(p,s), tight(p,s,t), o, cum(p,t), info(p), capa(s);
meet(p,t)..    sum(s, w(p,s,t)) =e= d(p,t);
setup(p,s)..   sum(t, w(p,s,t)) =l= bigm(p,'t1')*yv(p,s);
tight(p,s,t)$(ord(s) <= ord(t) and ord(t) - ord(s) < 3)..  w(p,s,t) =l= d(p,t)*yv(p,s);
cum(p,t)..     cumul(p,t) =e= sum((s,u)$(ord(s) <= ord(t) and ord(u) <= ord(t)), w(p,s,u));
info(p)..      sum(t, cumul(p,t)) =n= 100;
capa(s)..      sum((p,t), w(p,s,t)) =l= 16;
o..            cost =e= sum((p,s,t), hc(p,s,t)*w(p,s,t)) + sum((p,t), 20*yv(p,t)) - 1e-3*sum((p,t), cumul(p,t));
yv.lo(p,t) = 0; yv.up(p,t) = 1; yv.fx('p1','t1') = 1; cumul.up(p,t) = 90;
model lots / all /;
solve lots minimizing cost using lp;
