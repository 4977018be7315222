* `na` and a false condition, in sums and loops.
set i / a, b /; parameter p(i) / a na, b 3 /, q(i);
q(i) = sum(i.local$(p(i) > 0 and 1 > 2), 1); display q;
q(i) = 5; loop(i$(p(i) > 0 and ord(i) > 1), q(i) = 9); display q;
*> ----      3 PARAMETER q
*>
*> a 1.000,    b 1.000
*>
*> ----      4 PARAMETER q
*>
*> a 9.000,    b 9.000
