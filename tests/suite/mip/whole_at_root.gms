* bmod only: a whole local optimum at the root does not end the search where another start has a better one
* f has minima at y = 2 (value 1) and y = -2 (value 0), both whole.
integer variable y; variable f, t; equation step, obj;
y.lo = -3; y.up = 3; y.l = 3; t.l = 1;
step.. t =e= (y + 2)/4;
obj.. f =e= sqr(sqr(y) - 4) + 3*sqr(t) - 2*power(t,3);
model m / all /;
solve m using minlp minimizing f;
*= f.l 0
*= y.l -2
