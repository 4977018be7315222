$title Nonlinear rows of every relation and sign of variable, maximisation, products of sums, a quotient of sums, powers with variables in both places
set i / i1*i5 /, g / a, b /, in(g,i) / a.(i1*i3), b.(i3*i5) /; alias (i,j), (g,gg);
parameter a(i), c(g,gg); a(i) = 1 + ord(i)/4; c(g,gg) = 1/(1 + ord(g) + ord(gg));
positive variable x(i); negative variable y(g); variable w(g), z;
equations r1(g), r2(g), r3(i), r4, r5(g,gg), r6, o;
r1(g)..   sum(in(g,i), a(i)*x(i))/sum(in(g,i), x(i) + .1) =l= 1.9 - y(g)/9;
r2(g)..   w(g) =e= sum(i$in(g,i), x(i))*sum(j$(not in(g,j)), x(j)) + y(g)*prod(gg$(not sameas(g,gg)), 1 + w(gg)/10);
r3(i)$(ord(i) > 1).. x(i)**1.5 - (x(i-1) + .2)**a(i) =g= -4;
r4..      sum(i, (1 + x(i))**(0.5 + 0.1*x(i))) =l= 14;
r5(g,gg)$(ord(g) <> ord(gg))..  exp(c(g,gg)*(w(g) - w(gg))/10) - y(g) =n= 1;
r6..      sum((g,gg), c(g,gg)*w(g)*w(gg)) - sum(g, power(y(g),4)) =l= 30;
o..       z =e= sum(g, w(g)) - sum(i, sqr(x(i) - a(i))) - .1*sum(g, sqr(y(g) + 1)) + sum(i, sin(x(i))*cos(x(i++1)));
x.up(i) = 4; x.lo('i2') = .3; y.lo(g) = -5; x.l(i) = 1; y.l(g) = -1; w.l(g) = 1; y.up('b') = -.5;
model m / all /;
solve m maximizing z using nlp;
