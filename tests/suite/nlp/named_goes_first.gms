* bmod only: a solver that is named goes first, not alone; where it ends at a point of least violation, another looks elsewhere
* The smallest circle around three others: two of them, side by side, need 6 + 8.
set i / i1*i3 /;  alias (i,j);
parameter r(i);  r(i) = 2*ord(i) + 2;
variables radius, x(i), y(i);
equations inside(i), apart(i,j);
inside(i)..  sqr(radius - r(i)) =g= sqr(x(i)) + sqr(y(i));
apart(i,j)$(ord(i) < ord(j))..  sqr(x(i) - x(j)) + sqr(y(i) - y(j)) =g= sqr(r(i) + r(j));
x.lo(i) = -100;  x.up(i) = 100;  y.lo(i) = -100;  y.up(i) = 100;  radius.lo = 0.05;  radius.up = 100;
x.l(i) = 10*ord(i) - 20;  y.l(i) = 30*mod(ord(i),2) - 10;
model m / all /;
option nlp = pounce;
solve m using nlp minimizing radius;
*= m.modelstat 2
*= radius.l 14
