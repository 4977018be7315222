* A loop around one assignment, within another that does more: every index of the right side that does not run in the
* assignment is looked for, those of the outer loop and labels behind the loop's own too.
set l / a, b, c /, j / x, y /;  alias(l,o,n);
parameter q(l,l) / b.c 1, c.a 2 /, r(l,l,l) / b.a.c 4, c.b.a 5 /, p(j), by(l), back(l,l), ahead(l,l), twice(l);
loop(o, p(j) = 9;  loop(l, p(j) = q(l,o));              by(o) = p('x'));
loop((o,n), p(j) = 9;  loop(l, p(j) = r(l,o,n));        back(o,n) = p('x'));
loop((o,n), p(j) = 9;  loop(l, p(j) = r(o,n,l));        ahead(o,n) = p('x'));
loop(o, p(j) = 9;  loop(l, p(j) = r(o,o,l));            twice(o) = p('x'));
option decimals = 0;  display by, back, ahead, twice;
*> ----      9 PARAMETER by
*>
*> a 2,    b 9,    c 1
*>
*> ----      9 PARAMETER back
*>
*>             a           b           c
*>
*> a           9           9           4
*> b           5           9           9
*> c           9           9           9
*>
*> ----      9 PARAMETER ahead
*>
*>             a           b           c
*>
*> a           9           9           9
*> b           4           9           9
*> c           9           5           9
*>
*> ----      9 PARAMETER twice
*>
*> a 9,    b 9,    c 9
