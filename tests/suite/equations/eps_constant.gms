* `eps` is 0 for a solver, as a constant and within a nonlinear term too.
parameter k / eps /, level, inside;
variable x, z;
x.lo = 1;  x.up = 5;
equation linear, kink;
linear.. z =e= k*(x - 14);
kink..   z =e= max(k*(14 - x), 14*k) + k*sqr(x);
model first / linear /, second / kink /;
solve first using lp minimizing z;
level = 1e250*z.l;
*= level 0
solve second using dnlp minimizing z;
inside = 1e250*z.l;
*= inside 0
