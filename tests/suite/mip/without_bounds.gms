* Integers without finite bounds: a parity that no search would find is seen in the rows, and a level may be negative.
integer variables n, k;
free variable z;
n.lo = -inf;
k.lo = -inf;
equations o, parity, odd, even;
o..       z =e= n + 3*k;
parity..  2*n - 2*k =e= 1;
odd..     n + 2*k =g= -7.5;
even..    n - k =e= 2;
model contradiction / o, parity /, m / o, odd, even /;
solve contradiction using mip minimizing z;
*= contradiction.modelstat 10
m.optCR = 0;
solve m using mip minimizing z;
*= m.modelstat 1
*= n.l -1
*= k.l -3
*= z.l -10
