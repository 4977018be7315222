* A loop around several assignments, each to a whole symbol, passes over turns for which no right side has a record.
set i / a, b, c /, j / x, y /, s(j), z(j) / x /;  parameter q(i) / b 2 /, r(i) / a 3 /, e(i), w(i,j) / b.x 5 /, p(j), t(j), u(j), k(j);
scalar one / 1 /;  e(i) = 0;
$macro new p(j) = 5;  t(j) = 7;  u(j) = 8;  s(j) = yes
new;  loop(i, p(j) = q(i);  t(j) = 0);                       display p, t;
new;  loop(i, p(j) = e(i);  t(j) = e(i);  u(j) = 0);         display p, t, u;
new;  loop(i, p(j) = q(i);  t(j) = r(i));                    display p, t;
new;  loop(i, if(one, p(j) = q(i);  t(j) = w(i,j)));         display p, t;
new;  loop(i, p(j) = q(i);  t(j) = p(j)$q(i));               display p, t;
new;  loop(i, p(j) = q(i);  s(j) = yes$r(i));                display p, s;
new;  loop(i, p(j) = q(i);  t(j) = p(j)*q(i));               display p, t;
new;  loop(i, p(j) = q(i);  t(j) = one);                     display p, t;
new;  loop(i, p(j) = 0;  t(j) = 0);                          display p, t;
new;  loop(i, p(j) = q(i);  t(j) = q(i);  display 'turn');   display p;
*> ----      5 PARAMETER p
*>
*> x 2.000,    y 2.000
*>
*> ----      5 PARAMETER t
*>
*>                       ( ALL       0.000 )
*>
*> ----      6 PARAMETER p
*>
*> x 5.000,    y 5.000
*>
*> ----      6 PARAMETER t
*>
*> x 7.000,    y 7.000
*>
*> ----      6 PARAMETER u
*>
*> x 8.000,    y 8.000
*>
*> ----      7 PARAMETER p
*>
*> x 2.000,    y 2.000
*>
*> ----      7 PARAMETER t
*>
*>                       ( ALL       0.000 )
*>
*> ----      8 PARAMETER p
*>
*> x 2.000,    y 2.000
*>
*> ----      8 PARAMETER t
*>
*> x 5.000
*>
*> ----      9 PARAMETER p
*>
*> x 2.000,    y 2.000
*>
*> ----      9 PARAMETER t
*>
*> x 2.000,    y 2.000
*>
*> ----     10 PARAMETER p
*>
*> x 2.000,    y 2.000
*>
*> ----     10 SET s
*>
*>                                                       ( EMPTY )
*>
*> ----     11 PARAMETER p
*>
*>                       ( ALL       0.000 )
*>
*> ----     11 PARAMETER t
*>
*>                       ( ALL       0.000 )
*>
*> ----     12 PARAMETER p
*>
*>                       ( ALL       0.000 )
*>
*> ----     12 PARAMETER t
*>
*> x 1.000,    y 1.000
*>
*> ----     13 PARAMETER p
*>
*>                       ( ALL       0.000 )
*>
*> ----     13 PARAMETER t
*>
*>                       ( ALL       0.000 )
*>
*> ----     14 turn
*>
*> ----     14 turn
*>
*> ----     14 turn
*>
*> ----     14 PARAMETER p
*>
*>                       ( ALL       0.000 )
