* What is assigned anew is empty when it is counted; where some of it stays it is not.
set i / a, b, c /, s(i) / a, b /;  parameter p(i) / a 1, b 2 /, q(i) / a 1, b 2 /, r(i) / a 1, b 2 /;
p(i) = card(p) + 4$(ord(i) = 3);
q(i)$(ord(i) > 1) = card(q);
r(i) = r(i) + card(r);
s(i) = card(s) = 2;
display p, q, r, s;
*> ----      7 PARAMETER p
*>
*> c 4.000
*>
*> ----      7 PARAMETER q
*>
*> a 1.000,    b 2.000,    c 2.000
*>
*> ----      7 PARAMETER r
*>
*> a 3.000,    b 4.000,    c 2.000
*>
*> ----      7 SET s
*>
*>                                                       ( EMPTY )
