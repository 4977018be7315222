* bmod only: a term of 4e16 in the objective is no proof that there is no point.

*= impossible 0
*= x.l 24331.879
variables x, z;
equations o, r1, r2, r3;
x.lo = 0;
x.up = 1e11;
o.. z =e= 3.59*x + power(x,4)/10 + exp(-x);
r1.. x =g= 23905.77548;
r2.. 3.4*x =g= 22267.70552;
r3.. 1.77*x =g= 43067.4263256;
model m / all /;
solve m using nlp minimizing z;
scalar impossible;
impossible = 1$(m.modelStat = 4);
