$title Offsets that depend on the index itself, on data of other indices, on counts; conditions in place of lags
set t / t1*t9 /, k / k1*k3 /, e(t); alias (t,s,u);
parameter n(k) / k1 1, k2 -2, k3 3 /, w(t), back(t) / t3 1, t5 2, t8 -1 /; w(t) = 1 + mod(3*ord(t),5); e(t) = mod(ord(t),2) = 0;
variables x(t), y(k,t), z; positive variable x;
equations a(t), b(k,t), c(t), d(t), f, g(t), o;
a(t)..              x(t+ord(t)) + x(t-back(t)) =g= w(t)$(ord(t) < 5);
b(k,t)$(ord(t) > 2).. y(k,t+n(k)) - y(k,t) + x(t--n(k)) =l= ord(k) + card(e);
c(t)..              sum(s$(ord(s) = ord(t) + 1), x(s)) + sum(u$(abs(ord(u) - ord(t)) le 1), x(u)) =g= 2$e(t);
d(e(t))..           x(t) =l= 3*sum(s$(e(s) and ord(s) <> ord(t)), x(s)) + 5;
f..                 sum((t,k)$(ord(t) = 3*ord(k)), y(k,t++n(k))) =e= x('t1') + x('t9');
g(t+1)$(not e(t)).. x(t) - x(t+1) =l= smax(s$(ord(s) <= ord(t)), w(s));
o..                 z =e= sum(t, w(t)*x(t)) + sum((k,t), 2*y(k,t)) + sum((k,t)$(card(t) - ord(t) < ord(k)), x(t-(card(t) - 2)));
y.lo(k,t) = -3; y.up(k,t) = 6; x.up(t) = 40;
model m / all /;
solve m using lp minimizing z;
