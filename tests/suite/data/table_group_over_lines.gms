* A group of labels in the name of a row may go on in further lines; values stand in the last one.
set i / ground, chips, logs, bark /, j / in, out /, k / a, b, c /;
table t(i,j)
                in   out
(ground
 chips)         40    55
logs             7          ;
table u(k,i,j)
                 in    out
a.(ground,
   bark)          1
(b,
 c).(logs,chips)      2.5 ;
display t, u;
*> ----     14 PARAMETER t
*>
*>                 in         out
*>
*> ground      40.000      55.000
*> chips       40.000      55.000
*> logs         7.000
*>
*> ----     14 PARAMETER u
*>
*>                   in         out
*>
*> a.ground       1.000
*> a.bark         1.000
*> b.chips                    2.500
*> b.logs                     2.500
*> c.chips                    2.500
*> c.logs                     2.500
