* A scale that is 0, negative or no number stops the solve that would use it.
variable x, z;  equation o;  o.. z =e= x;  x.lo = 1;  x.scale = 0;
model m / all /;
solve m using lp minimizing z;
m.scaleOpt = 1;
solve m using lp minimizing z;
*! execution 6
