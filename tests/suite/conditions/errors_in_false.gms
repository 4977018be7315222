* A condition is evaluated where another one is false, so that an error in it is reported.
set i / a, b /;  parameter p(i), q(i) / a 1 /, n(i) / a 2 /;  scalar zero / 0 /;
p(i)$(q(i) and 1/n(i) < 2) = 1;  display p;
p(i)$(ord(i) > 5 and 1/zero > 2) = 3;  display p;
*! execution 4
*> ----      3 PARAMETER p
*>
*> a 1.000
*>
*> ----      4 PARAMETER p
*>
*> a 3.000,    b 3.000
