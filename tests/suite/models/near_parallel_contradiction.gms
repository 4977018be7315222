* bmod only: nearly parallel rows that contradict each other, as multipliers prove.

*= m.modelstat 4
variables z, x0, x1, x2;
equations obj, r0, r1;
x0.lo = 0.0;
x0.up = 1000000.0;
x1.lo = 0.0;
x1.up = 1000000.0;
x2.lo = 0.0;
x2.up = 1000000.0;
obj.. z =e= (-2.0)*x0 + (-3.0)*x1 + (-3.0)*x2;
r0.. (1.0)*x0 + (2.0)*x1 + (-3.0)*x2 =g= 2.0;
r1.. (1.000000001)*x0 + (1.999999998)*x1 + (-2.999999997)*x2 =l= 1.999999;
model m /all/;
solve m using lp minimizing z;
