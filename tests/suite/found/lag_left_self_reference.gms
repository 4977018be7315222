* A lag on the left with the same symbol behind it assigns element by element.
set t / t1*t5 /; parameter p(t); p(t) = ord(t);
p(t+1) = 10 + p(t-1); display p;
*> ----      3 PARAMETER p
*>
*> t1  1.000,    t2 10.000,    t3 11.000,    t4 20.000,    t5 21.000
