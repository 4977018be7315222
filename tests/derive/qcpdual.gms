$title A convex quadratic program with squares of differences, products over an alias, bounds of all kinds, a maximum, fixed and free columns
set i / i1*i6 /, k / k1*k3 /; alias (i,j);
parameter f(k,i), tgt(i), d(i); f(k,i) = mod(ord(k)*ord(i) + ord(i),5) - 2; tgt(i) = ord(i)/2; d(i) = 1 + ord(i)/5;
positive variable x(i); variable y(k), u;
equations fac(k), bud, gap(i), util;
fac(k)..   y(k) =e= sum(i, f(k,i)*x(i));
bud..      sum(i, x(i)) =l= 9;
gap(i)$(ord(i) < card(i))..  x(i) - x(i+1) =g= -2;
util..     3*u =e= sum(i, 4*x(i)) - .5*(sum(k, sqr(y(k))) + sum(i, d(i)*sqr(x(i) - tgt(i)))) - .1*sum((i,j)$(ord(i) = ord(j)), x(i)*x(j)) - power(y('k1') - 1,2) + 5;
x.up(i)$(ord(i) > 3) = 2.5; x.lo('i2') = .5; x.fx('i6') = 1.2; y.lo('k2') = -3;
model q / all /;
solve q maximizing u using qcp;
