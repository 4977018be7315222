* Under `$onWarning` a label outside the domain is kept.
$onWarning
set i / a, b /, j(i) / a, c /;
parameter p(i) / a 1, c 2 /;
table t(i,*)
     x  y
a    1  2
c    3  4
;
$offWarning
scalar n;
n = card(p) + 10*card(j);
display j, p, t;
*= n 22
*= p('c') 2
*> ----     13 SET j
*>
*> a,    c
*>
*> ----     13 PARAMETER p
*>
*> a 1.000,    c 2.000
*>
*> ----     13 PARAMETER t
*>
*>             x           y
*>
*> a       1.000       2.000
*> c       3.000       4.000
