* Past the end of a set an attribute has the value that it has where nothing is stored.
set t / t1*t3 /;  positive variable x(t);  x.up(t) = 4;  x.scale(t) = 2;  parameter r(t,*);
r(t,'lo') = x.lo(t-1);  r(t,'up') = x.up(t-1);  r(t,'scale') = x.scale(t-1);
display r;
*> ----      4 PARAMETER r
*>
*>             up       scale
*>
*> t1        +INF       1.000
*> t2       4.000       2.000
*> t3       4.000       2.000
