* A set that found an index, as `k` under `loop(k(i), …)`, finds no second one.
set i / a, b /, k(i) / a, b /, l(i,i) / a.b /;  alias(i, j), (k, kk);  parameter p(i), q(i,i);  variable z;  equation e(i,i);
q(k(i),k(j)) = 1;
loop(k(i), p(k(i)) = 1);
loop(l(i,j), q(l(i,j)) = 1);
e(k(i),k(j)).. z =g= 1;
q(k(i),kk(j)) = 1;
loop(k, p(k(i)) = 1);
*! error 3
*! error 4
*! error 5
*! error 6
