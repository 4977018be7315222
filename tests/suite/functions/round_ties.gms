* A tie is decided by |x|*10**d + 0.5 in doubles: 0.35 goes up, and so does the number below one half.
set i / 1*8 /; parameter p(i);
p('1') = round(0.35,1);  p('2') = round(1.005,2);  p('3') = round(19.095,2);  p('4') = round(-8.35,1);
p('5') = round(0.49999999999999994);  p('6') = round(1250,-2);  p('7') = round(-0.5);  p('8') = round(2.675,2);
option decimals = 4;  display p;
*> ----      5 PARAMETER p
*>
*> 1    0.4000,    2    1.0000,    3   19.1000,    4   -8.4000,    5    1.0000,    6 1300.0000,    7   -1.0000,    8    2.6800
