* A loop around one assignment to several elements passes over turns for which the right side has no record.
set i / a, b /, j / x, y /, sj(j) / x /, k(i);  parameter q(j) / x 5 /, none(j), w(i,j) / a.x 3 /, p(i);
none(j) = 0;
p(i) = 2;  loop(j, p(i) = none(j));         display p;
p(i) = 2;  loop(j, p(i) = 3*q(j));          display p;
p(i) = 2;  loop(j, p(i) = q(j) + 1);        display p;
p(i) = 2;  loop(j, p(i) = w(i,j));          display p;
p(i) = 2;  loop(j, p(i) = q(j); p(i) = p(i)); display p;
k(i) = yes;  loop(j, k(i) = sj(j));         display k;
parameter q2(j,i) / y.a 5 /, q3(j,j) / x.y 7 /;
p(i) = 2;  loop(j, p(i) = q2(j,i));         display p;
p(i) = 2;  loop(j, p(i) = abs(q3(j,j+1)));  display p;
*> ----      4 PARAMETER p
*>
*> a 2.000,    b 2.000
*>
*> ----      5 PARAMETER p
*>
*> a 15.000,    b 15.000
*>
*> ----      6 PARAMETER p
*>
*> a 1.000,    b 1.000
*>
*> ----      7 PARAMETER p
*>
*>                       ( ALL       0.000 )
*>
*> ----      8 PARAMETER p
*>
*>                       ( ALL       0.000 )
*>
*> ----      9 SET k
*>
*> a,    b
*>
*> ----     11 PARAMETER p
*>
*> a 5.000
*>
*> ----     12 PARAMETER p
*>
*> a 7.000,    b 7.000
