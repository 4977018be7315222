* A loop whose one statement assigns from a parameter without records.
set i / a, b /, j / x, y /; parameter p(i), q(j); q(j) = 0;
p(i) = 2; loop(j, p(i) = q(j)); display p;
*> ----      3 PARAMETER p
*>
*> a 2.000,    b 2.000
