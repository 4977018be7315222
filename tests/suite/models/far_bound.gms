* bmod only: the rounding error of a basic column is no complementarity with a bound 1e12 away.

*= m.modelstat 1
*= x.l 0.9029345372460496
variables z, x;
equations obj, r;
x.up = 1e12;
obj.. z =e= 3.14*x;
r.. -4.43*x =l= -4;
model m /all/;
solve m using lp minimizing z;
