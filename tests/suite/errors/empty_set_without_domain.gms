* Empty data do not say how many indices a set has.
set s(*) / /;  parameter p / /;
set t / /;
*! error 3
