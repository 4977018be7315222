* Where abs stands nonconvexly, a local optimum is not called a global one, although its second derivatives are 0: x = -1 is better.
Variables x, z;
x.lo = -1;  x.up = 5;  x.l = 4;
Equations cost, away;
cost..  z =e= x;
away..  abs(x - 1) =g= 1;
Model m / all /;
solve m using dnlp minimizing z;
*= x.l 2
*= m.modelstat 2
