* Neither a domain nor a record says how many indices a parameter has; a display specification of two numbers.
parameter p / /;
parameter q(*,*) / a.b 1 /;
option q:2:1;
p = 3;
*! error 2
*! error 4
