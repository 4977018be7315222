* Model statuses of programs with discrete variables, and what stays where there is no solution.
integer variables x, y;
free variable z;
x.up = 8;
y.up = 8;
x.l = 3;
y.l = 4;
z.l = 11;
equations cost, more, less, odd, far;
cost..  z =e= x + 2*y;
more..  2*x + 2*y =g= 5;
less..  x + y =l= 5;
odd..   2*x + 2*y =e= 3;
far..   x + y =g= 10;
model contradiction / cost, less, far /, parity / cost, less, odd /, fine / cost, less, more /;
fine.optCR = 0;

solve contradiction using mip minimizing z;
*= contradiction.modelstat 10
*= contradiction.solvestat 1
*= contradiction.objval na
solve parity using mip minimizing z;
*= parity.modelstat 10
scalars kept, at;
kept = x.l;
at = z.l;
*= kept 3
*= at 11
solve fine using mip minimizing z;
*= fine.modelstat 1
*= fine.objval 3
*= fine.objest 3
*= fine.numdvar 2
*= x.l 3
*= y.l 0
