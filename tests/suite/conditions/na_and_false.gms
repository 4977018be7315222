* `na and 0` is `na`, and that counts as true, wherever the condition stands.
set i / a, b, c /, m(i) / b /;  parameter p(i) / a na, b 3 /, q(i);  scalar s, t, r;
q(i) = 5;  q(i)$(p(i) > 0 and ord(i) > 1) = 2;  display q;
q(i) = 5;  loop(i$(m(i) and p(i) > 0), q(i) = 9);  display q;
s = sum(i$(p(i) > 0 and ord(i) > 5), 1);  t = sor(i, p(i) > 9);  r = sand(i, p(i) >= 0);
display s, t, r;
*> ----      3 PARAMETER q
*>
*> a 2.000,    b 2.000,    c 5.000
*>
*> ----      4 PARAMETER q
*>
*> a 9.000,    b 9.000,    c 5.000
*>
*> ----      6 PARAMETER s                    =        1.000
*>             PARAMETER t                    =           NA
*>             PARAMETER r                    =           NA
