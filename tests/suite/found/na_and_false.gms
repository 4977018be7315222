* `na` and a false condition, in the condition of an assignment.
set i / a, b /; parameter p(i) / a na, b 3 /, q(i); q(i) = 5;
q(i)$(p(i) >= 1 and ord(i) > 1) = 2; display q;
*> ----      3 PARAMETER q
*>
*> a 2.000,    b 2.000
