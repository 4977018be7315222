$title A convex program with quadratic rows: a ball, ellipses over a lead, a quadratic objective, bounds
set i / i1*i4 /; parameter c(i) / i1 -1, i2 2, i3 .5, i4 1 /, w(i) / i1 2, i2 1, i3 3, i4 1 /;
positive variable s(i); variable x(i), y, z;
equations ball, ell(i), far(i), lin, o;
ball..                       sum(i, w(i)*sqr(x(i) - c(i)/4)) =l= 4 + .5*y;
ell(i)$(ord(i) < card(i))..  sqr(x(i) - x(i+1)) + x(i)*x(i) =l= 2 + s(i);
far(i)..                     9 - power(x(i) + y,2) =g= -s(i);
lin..                        sum(i, x(i)) =g= -3;
o..                          z =e= sum(i, c(i)*x(i) + 3*s(i) + .1*sqr(s(i))) + sqr(y - 1)/2;
y.up = 2; x.lo('i2') = -.6; x.fx('i3') = .1;
model m / all /; solve m using qcp min z;
