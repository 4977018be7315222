* Relations between variables may stand in an minlp: GAMS asks for dnlp only where an nlp has them.
set i / 1*4 /;
binary variable x(i);
variable c(i), z;
equations d(i), s, o;
d(i).. c(i) =e= ifthen(x(i) >= 0.5, ord(i), 10);
s..    sum(i, x(i)) =e= 2;
o..    z =e= sum(i, sqr(c(i)));
model m / all /;
option optcr = 0;
solve m using minlp minimizing z;
*= m.solvestat 1
*= m.modelstat 8
