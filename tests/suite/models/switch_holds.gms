* bmod only: a switch of any size that is on holds its row: no part of its size is a tolerance.

*= m1.modelstat 1
*= z1.l 10
*= m2.modelstat 1
*= z2.l 0.001
*= m3.modelstat 1
*= z3.l 0.001
scalar M / 1e12 /;
binary variable u;
positive variable p;
variables z1, z2, z3;
equations o1, o2, o3, big, bigger, full, some;
o1.. z1 =e= p + 5*u;
o2.. z2 =e= p + 0.001*u;
o3.. z3 =e= p + 0.001*u;
big.. p =l= 1e7*(1 - u);
bigger.. p =l= M*(1 - u);
full.. p =l= 10;
some.. u + p =g= 1;
model m1 / o1, bigger, full, some /;
model m2 / o2, big, full /;
model m3 / o3, bigger, full /;
option optcr = 0;
* HiGHS calls 5 the optimum of the first
option mip = bmip;
solve m1 using mip maximizing z1;
u.lo = 1;
solve m2 using mip maximizing z2;
solve m3 using mip maximizing z3;
