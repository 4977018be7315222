* A second program whose row keeps the cost of a first, rounded by 8e-8: no point satisfies all rows, but one does to the
* tolerance, and that is optimal, whether the row is an equation or an inequality.
set i / i1*i5 /, j / j1*j5 /;
parameter a(i), b(j), c(i,j);
b(j) = 5 + mod(7*ord(j), 11) + 1/3;
a(i) = 8 + mod(5*ord(i), 13) + 1/7;
a('i1') = a('i1') + max(0, sum(j, b(j)) - sum(i, a(i)));
c(i,j) = 1 + mod(ord(i)*ord(j), 17)/3;
positive variable x(i,j);
variable z, w;
scalar best, kept, below, near;
equation cost, sup(i), dem(j), keep, most, second;
cost..   z =e= sum((i,j), c(i,j)*x(i,j));
sup(i).. sum(j, x(i,j)) =l= a(i);
dem(j).. sum(i, x(i,j)) =e= b(j);
second.. w =e= sum((i,j), sqr(ord(i) - ord(j))*x(i,j));
keep..   z =e= best;
most..   z =l= best;
model first / cost, sup, dem /, again / cost, sup, dem, second, keep /, other / cost, sup, dem, second, most /;
solve first using lp minimizing z;
best = z.l - 8e-8;
solve again using lp minimizing w;
kept = again.modelstat;
near = w.l;
solve other using lp minimizing w;
below = other.modelstat;
near = 1$(abs(near - w.l) < 1e-4 and abs(z.l - best) < 1e-6);
*= kept 1
*= below 1
*= near 1
