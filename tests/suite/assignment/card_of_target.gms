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

* Where the set is read as well, in sums over it or by its members, it is counted as it was.
set w / a, b, c, d /;  alias(w,v);  set half(w) / a, c /, s1(w), s2(w), s3(w), s4(w), s5(w);
s1(w) = yes;  s1(w) = 0 gt smax(s1$half(w), card(s1));
s2(w) = yes;  s2(w) = sand((v,s2), ord(v) > card(s2));
s3(w) = yes;  s3(w) = smin(s3, card(s3)) = 4;
s4(w) = yes;  s4(w) = smax(v$s4(v), card(s4)) ne 4;
s5(w) = yes;  s5(w) = sum(s5, card(s5)) <> 16;
scalar n1, n2, n3, n4, n5, has_b;
n1 = card(s1); n2 = card(s2); n3 = card(s3); n4 = card(s4); n5 = card(s5); has_b = 1$s1('b');
*= n1 2
*= has_b 1
*= n2 0
*= n3 4
*= n4 0
*= n5 0
