* What is held fixed has its value as level after the solve; its marginal stays.
set i / a, b, c /;  positive variable x(i);  variable z;  equation cost, need(i);
cost.. z =e= sum(i, ord(i)*x(i));  need(i).. x(i) =g= 2*ord(i);
x.fx('b') = 5;  x.l('b') = 1;  x.m('b') = 7;
model m / all /;  m.holdFixed = 1;
solve m using lp minimizing z;
display x.l, x.m, z.l, need.lo, need.l, m.numVar;
*> ----      7 VARIABLE x.L
*>
*> a 2.000,    b 5.000,    c 6.000
*>
*> ----      7 VARIABLE x.M
*>
*> b 7.000
*>
*> ----      7 VARIABLE z.L                   =       30.000
*>
*> ----      7 EQUATION need.Lo
*>
*> a  2.000,    b -1.000,    c  6.000
*>
*> ----      7 EQUATION need.L
*>
*> a 2.000,    c 6.000
*>
*> ----      7 MODEL m.NumVar                 =        3.000
