* `execute_loaddc` with a label outside the domain: an error, and what fits is there.
set i / a, b /;  parameter p(*) / a 1, q 2 /, r(i);  r(i) = 7;
execute_unload 'wrong_label.gdx', p;
execute_loaddc 'wrong_label.gdx', r = p;
r(i) = r(i) + 1;  display r;
*! execution 4
*> ----      5 PARAMETER r
*>
*> a 2.000,    b 1.000
