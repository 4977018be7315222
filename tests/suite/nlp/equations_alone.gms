* bmod only. Entropy of a table with given sums: equations only, so the working set is known at the start, and Newton's method needs no linear programs.
set i / 1*30 /;
alias(i, j);
set p(i, j);
p(i, j) = mod(7*ord(i) + 3*ord(j), 5) < 3;
parameter a(i, j), r(i), c(j);
a(p(i, j)) = 1 + mod(ord(i)*ord(j), 37);
r(i) = sum(p(i, j), a(p)*(1 + 0.2*sin(ord(i) + 2*ord(j))));
c(j) = sum(p(i, j), a(p)*(1 + 0.2*sin(ord(i) + 2*ord(j))));
positive variable x(i, j);
variable z;
equations o, rows(i), columns(j);
o..          z =e= sum(p, x(p)*log(x(p)/a(p)));
rows(i)..    sum(p(i, j), x(p)) =e= r(i);
columns(j)$(ord(j) < card(j)).. sum(p(i, j), x(p)) =e= c(j);
x.l(p) = a(p);
x.lo(p) = 1e-5;
model m / all /;
solve m using nlp minimizing z;
parameter few;
few = m.iterusd < 5;
*= m.modelstat 1
*= few 1
