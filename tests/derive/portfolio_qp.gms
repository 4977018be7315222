$title A frontier: quadratic form over an alias, qcp in a loop, bounds changed between solves
set s / hw, sw, elec, show /, n / n1*n3 /; alias (s,t);
table v(s,t)
        hw   sw   elec  show
 hw      4    3    -1     0
 sw      3    6     1     0
 elec   -1    1    10     0
 show    0    0     0     0.1 ;
parameter m(s) / hw 8, sw 9, elec 12, show 7 /, rep(n,*); scalar tgt / 8.5 /;
variable x(s), var; positive variable x;
equations fsum, dmean, dvar;
fsum..   sum(s, x(s)) =e= 1;
dmean..  sum(s, m(s)*x(s)) =g= tgt;
dvar..   sum((s,t), x(s)*v(s,t)*x(t)) =e= var;
model mv / all /;
loop(n, tgt = 7.5 + ord(n); x.up(s) = 0.9 - 0.1*ord(n); solve mv minimizing var using qcp; rep(n,'var') = var.l; rep(n,s) = x.l(s););
display rep;
