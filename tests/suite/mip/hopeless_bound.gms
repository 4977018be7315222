* bmod only: products of integers with wide bounds: in bits they are a linear program of hundreds of columns whose bound is a hundred
* times the answer. The tree over the nonlinear program ends after some nodes, and what it finds is the answer.
set k / k1*k8 /, r / r1*r8 /;
alias (k, l);
parameter q(r,k,l), b(r);
q(r,k,l) = mod(7*ord(r) + 3*ord(k)*ord(l) + 5*ord(k), 5) - 2;
q(r,k,k) = 9 + mod(ord(r) + ord(k), 4);
b(r) = 900 + 40*ord(r);
integer variable x(k);
variable z;
x.up(k) = 200;
x.l(k) = 1;
equations cost, ball(r);
cost.. z =e= sum(k, (4 + mod(3*ord(k), 5))*x(k)) + 0.1*sum((k,l), q('r1',k,l)*x(k)*x(l)) - 0.9*sum(k, sqr(x(k)));
ball(r).. sum((k,l), q(r,k,l)*x(k)*x(l)) =l= b(r);
model m / all /;
m.resLim = 30;
solve m using minlp maximizing z;
scalar fine 'all rows are satisfied by whole numbers';
fine = smax(r, sum((k,l), q(r,k,l)*x.l(k)*x.l(l)) - b(r)) <= 1e-6 and smax(k, abs(x.l(k) - round(x.l(k)))) <= 1e-6;
*= m.modelstat 8
*= m.solvestat 1
*= fine 1
*= z.l 181.7
