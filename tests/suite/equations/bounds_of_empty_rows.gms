* A row without variables is not solved; its bounds are those that it says, its level is 0.
set i / a, b, c /;  positive variable x(i);  variable z;  equation e(i), cost;
e(i).. sum(i.local$(ord(i) > 2), x(i))$(ord(i) = 3) =l= 5 - ord(i);
cost.. z =e= sum(i, x(i));
e.l('a') = 8;  e.m('b') = 3;
model m / all /;  solve m using lp minimizing z;
display e.lo, e.up, e.l, e.m, e.slack;
*> ----      7 EQUATION e.Lo (-INF)
*>
*>                       ( ALL        -INF )
*>
*> ----      7 EQUATION e.Up
*>
*> a 4.000,    b 3.000,    c 2.000
*>
*> ----      7 EQUATION e.L
*>
*>                       ( ALL       0.000 )
*>
*> ----      7 EQUATION e.M
*>
*>                       ( ALL       0.000 )
*>
*> ----      7 EQUATION e.Slack
*>
*> a 4.000,    b 3.000,    c 2.000
