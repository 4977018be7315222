* Where a nonlinear program with integers is infeasible, its levels are those at which the nonlinear solver stopped.
variables x, y, z;  binary variable b;
x.up = 10;  y.up = 10;  x.lo = 1;  y.lo = 1;
equations product, sum_, objective;
product.. x*y =e= 4 + b;
sum_.. x + y =g= 12;
objective.. z =e= x + b;
model m / all /;
solve m using minlp minimizing z;
abort$(m.modelstat <> 4 and m.modelstat <> 5) "feasible";
abort$(x.l < 0.5) 'the levels of the start';
