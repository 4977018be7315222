* A set has no value of its own, as a number, a condition or in `put`; which of its values is meant is said.
set i / a, b /;  parameter p(i);  scalar n;
p(i) = i;
loop(i, if(i, n = 1));
file f / 'set_as_value.txt' /;  put f;
loop(i, put i /);
loop(i, put i.tl /);
p(i) = i(i);
*! error 3
*! error 4
*! error 6
