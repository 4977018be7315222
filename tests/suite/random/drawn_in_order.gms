* Random numbers inside `$` conditions and sums are drawn in the order of the left side.
set i / a, b, c /, j / x, y /;  parameter p(j,i), q(i) / a 1, c 2 /, r(i), s(i);  scalar u;
p(j,i) = 1$(uniform(0,1) < 0.5);  display p;
r(i) = uniform(0,1)$(uniform(0,1) > 0.5) + q(i)$(uniform(0,1) > 0.5);  display r;
s(i) = q(i)*sum(i.local, uniform(0,1));  u = uniform(0,1);  display s, u;
*> ----      3 PARAMETER p
*>
*>             a           b           c
*>
*> x       1.000
*> y       1.000       1.000       1.000
*>
*> ----      4 PARAMETER r
*>
*> a 1.000,    c 2.579
*>
*> ----      5 PARAMETER s
*>
*> a 1.533,    c 2.293
*>
*> ----      5 PARAMETER u                    =        0.131
