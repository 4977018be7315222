* `$=` evaluates the right side once.
set i / a, b, c /;  parameter p(i), v(i) / a eps, c na /, w(i);  scalar after;
p(i) $= uniform(0,1);  after = uniform(0,1);
w(i) = 4;  w(i)$(ord(i) < 3) $= v(i);
display p, after, w;
*> ----      5 PARAMETER p
*>
*> a 0.172,    b 0.843,    c 0.550
*>
*> ----      5 PARAMETER after                =        0.301
*>
*> ----      5 PARAMETER w
*>
*> a   EPS,    b 4.000,    c 4.000
