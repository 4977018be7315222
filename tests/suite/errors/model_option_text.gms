* Options of models are numbers.
variable z;  equation e;  e.. z =e= 1;  model m / e /;
m.cutoff = 'x';
*! error 3
