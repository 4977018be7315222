* bmod only: a semicontinuous variable in small units: 0, or at least a ten-millionth. (GAMS with CPLEX gives 1e-9.)
semicont variable q;
free variable z;
equations o, c;
q.lo = 1e-7;
q.up = 1;
o..  z =e= 1e7*q;
c..  1e9*q =g= 1;
model m / all /;
m.optCR = 0;
solve m using mip minimizing z;
*= m.modelstat 1
*= z.l 1
