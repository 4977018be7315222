* bmod only: a convex function that has a variable of its own in the objective. GAMS's SBB says 8.
set i / 1*6 /;
alias(i, j);
parameter mean(i) / 1 2, 2 3, 3 5, 4 6, 5 8, 6 9 /, spread(i) / 1 1, 2 3, 3 4, 4 9, 5 11, 6 15 /;
variables z, variance, gain;
positive variable x(i);
binary variable y(i);
equations goal, square, linear, whole, use(i), few;
goal..  z =e= gain - 0.05*variance;
square..  variance =e= sum((i, j), x(i)*spread(i)*(0.3 + 0.7$sameas(i, j))*spread(j)*x(j));
linear..  gain =e= sum(i, mean(i)*x(i));
whole..  sum(i, x(i)) =e= 1;
use(i)..  x(i) =l= y(i);
few..  sum(i, y(i)) =l= 2;
model m / all /;
option optCR = 0;
solve m using minlp maximizing z;
*= m.modelstat 1
*= m.objval 4.686365280289
