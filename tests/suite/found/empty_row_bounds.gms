* Rows without variables are dropped: their bounds and slacks are gone.
set i / i1*i2 /; variable x(i), z; x.lo(i) = 0; equation e(i), o;
e(i).. sum(i.local$(ord(i) > 5), x(i)) =l= ord(i) + 1;
o.. z =e= sum(i, x(i)); model m / all /; solve m using lp min z;
parameter r(i,*); r(i,'up') = e.up(i); r(i,'slack') = e.slack(i); display r;
*> ----      5 PARAMETER r
*>
*>             up       slack
*>
*> i1       2.000       2.000
*> i2       3.000       3.000
