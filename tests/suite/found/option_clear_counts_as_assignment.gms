* `option clear` counts as an assignment.
set i / a, b /; parameter q(i), p(i); option clear = q;
p(i) = q(i) + 1; display p;
*> ----      3 PARAMETER p
*>
*> a 1.000,    b 1.000
