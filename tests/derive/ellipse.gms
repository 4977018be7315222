$title Least squares over a table, several families of functions, a variable in an exponent, objective in a row with other relations
set o / o1*o9 /; parameter x(o), y(o); x(o) = ord(o)/3; y(o) = 2*exp(-.5*x(o)) + .1*cos(5*ord(o));
variables a, b, c, sse, bound, res(o); 
equations f(o), ss, bnd, extra, chk;
f(o)..   res(o) =e= y(o) - a*exp(b*x(o)) - c*x(o)**b*0.01 - .001*tanh(a*x(o)) + .001*sigmoid(b)*arctan(c) - .001*log2(1 + sqr(a)) - .0001*log10(2 + b*b);
ss..     sse =g= sum(o, sqr(res(o))) + .001*sqr(a) + .001*abs(x('o1'))*c**2;
bnd..    sse =l= 100;
extra..  bound =e= sinh(b/2) + cosh(c/2) + arcsin(b/4) + arccos(c/9) + arctan2(2 + a,3) + edist(a,b,c) + errorf(a/3);
chk..    bound =l= 40;
a.l = 1; b.l = -1; c.l = .1; b.lo = -3; b.up = 2; c.lo = -3; c.up = 3; a.lo = -1; a.up = 5;
model fit / all /;
solve fit using nlp minimizing sse;
