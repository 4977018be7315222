* An option of a model outside its range ends the run at the solve; na, eps and fractions do not. Asked of GAMS 54.6.
variable z;  equation e;  e.. z =e= 1;  model m / e /;
scalar solved / 0 /;
m.optcr = eps;  m.reslim = na;  m.iterlim = 3.7;  m.cutoff = inf;  m.holdfixed = 3;  m.savepoint = 0;
solve m using lp minimizing z;
solved = m.modelstat;
m.nodlim = -5;
solve m using lp minimizing z;
*! execution 8
*= solved 1
