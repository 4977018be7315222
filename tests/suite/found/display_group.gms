* Wide displays with groups of columns.
set j / e, 10, u, label_that_is_rather_long_indeed_x /, k / 1993*1996 /;
parameter p(j,k,j,j) / 10.1994.10.10 4, u.1993.label_that_is_rather_long_indeed_x.u 5, label_that_is_rather_long_indeed_x.1993.e.10 6 /;
option p:6:1:2; display p;
*> ----      4 PARAMETER p
*>
*> INDEX 1 = 10
*>
*>            10.10
*>
*> 1994    4.000000
*>
*> INDEX 1 = u
*>
*>       label_tha~
*>                u
*>
*> 1993    5.000000
*>
*> INDEX 1 = label_that_is_rather_long_indeed_x
*>
*>                e
*>               10
*>
*> 1993    6.000000
