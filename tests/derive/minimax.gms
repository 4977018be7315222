$title Minimax fit: the objective variable in many rows, both relations, macros
$macro fitted(k) (c0 + sum(j, coef(j)*base(k,j)))
set k / k1*k12 /, j / lin, quad /;
parameter tt(k), y(k), base(k,j);
tt(k) = (ord(k) - 1)/(card(k) - 1);
y(k) = exp(-2*tt(k)) + 0.05*sin(9*ord(k));
base(k,'lin') = tt(k); base(k,'quad') = sqr(tt(k));
variables c0, coef(j), dev; 
equations above(k), below(k), monotone(k), pin;
above(k)..   fitted(k) - y(k) =l= dev;
below(k)..   y(k) - fitted(k) =l= dev;
monotone(k+1)$(ord(k) > 2)..  sum(j, coef(j)*base(k+1,j)) =l= sum(j, coef(j)*base(k,j));
pin..        fitted('k1') =n= 0.9;
dev.lo = 0;
model cheb / all /;
solve cheb minimizing dev using lp;
