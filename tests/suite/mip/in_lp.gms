* A discrete variable in a linear program.
integer variable x;
free variable z;
equation e;
e.. z =e= x;
model m / all /;
solve m using lp minimizing z;
*! error 5
*! gams 7
