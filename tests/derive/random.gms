$title Coefficients drawn while rows are generated, and attributes that are computed: these blocks stand by their rows
set i / i1*i4 /; alias (i,j);
variables x(i), z; equations f(i), g(i), h, o;
f(i)..  sum(j, uniform(0,1)*exp(x(j)/5)) =g= 1 + ord(i)/2;
g(i)..  x(i) =l= x.range(i) + uniform(1,2);
h..     sum(i, normal(1,.1)*x(i)) =g= -3;
o..     z =e= sum(i, ord(i)*sqr(x(i) - 1)) + uniform(1,2)*x('i2');
x.lo(i) = -2; x.up(i) = 3;
model m / all /;
solve m using nlp minimizing z;
