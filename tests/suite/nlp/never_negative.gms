* bmod only: what stands under `**` or a root cannot be negative: the search need not be told by a bound
$set n 100
set k / 0*%n% /;
scalar h; h = 3.6 / (%n%+1);
variables z, r(k), v(k), w(k), rdot(k), vdot(k), wdot(k), a(k);
equations far, out(k), radial(k), around(k), slope(k), pull(k), turn(k), circle, rest;
far..           z =e= r('%n%');
out(k+1)..      r(k+1) =e= r(k) + h*rdot(k);
radial(k+1)..   v(k+1) =e= v(k) + h*vdot(k);
around(k+1)..   w(k+1) =e= w(k) + h*wdot(k);
slope(k)..      rdot(k) =e= v(k);
pull(k)..       vdot(k) =e= w(k)**2/r(k) - 1/sqr(r(k)) + 0.14*sin(a(k));
turn(k)..       wdot(k) =e= 0.14*cos(a(k)) - v(k)*w(k)/r(k);
circle..        w('%n%') =e= 1/sqrt(r('%n%'));
rest..          rdot('%n%') =e= 0;
r.lo(k) = 0.1;
r.fx('0') = 1;  v.fx('0') = 0;  w.fx('0') = 1;
rdot.l(k) = 10000; vdot.l(k) = 10000; wdot.l(k) = 10000;
model transfer / all /;
solve transfer using nlp maximizing z;
*= transfer.modelstat 2
*= z.l 1.533394165
