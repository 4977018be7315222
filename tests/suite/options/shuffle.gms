* `option shuffle` lets the values over all elements of a parameter's set change places; one without values gets their
* positions.
set i / 1*10 /, j / 1*6 /;  parameter p(i), q(j) / 2 20, 4 40, 5 50 /;  scalar u;
option seed = 7;  option shuffle = p;  u = uniform(0,1);
option seed = 5;  option shuffle = q;
option decimals = 0;  display p, q;
*= u 0.586578927
*> ----      6 PARAMETER p
*>
*> 1   4,    2   1,    3   7,    4   9,    5   5,    6   3,    7   8,    8   2,    9   6,    10 10
*>
*> ----      6 PARAMETER q
*>
*> 1 20,    4 40,    5 50
