$title Several solves of several models, an equation in two of them, remove by minus, data changed by assignment, conditions by sums
$onEmpty
sets i / i1*i3 /, j / j1*j4 /, k / truck, rail /, link(i,j,k), none(i) / /;
link(i,j,k) = not (sameas(k,'rail') and ord(i) = 2) and (ord(i) + ord(j) > 2);
parameter a(i) / i1 40, i2 55, i3 30 /, b(j) / j1 20, j2 25, j3 30, j4 15 /, d(i,j), rate(k) / truck 2, rail 1.1 /, f(i,j,k);
d(i,j) = 1 + abs(2*ord(i) - ord(j)); f(link(i,j,k)) = rate(k)*d(i,j) + 0.5$sameas(k,'truck');
variable cost; positive variable x(i,j,k), buy(j);
equations sup(i), dem(j), obj, obj2, railcap(i), fair, never(i);
obj..    cost =e= sum(link, f(link)*x(link)) + 25*sum(j, buy(j));
obj2..   cost =e= sum(link(i,j,k), f(link)*x(i,j,k)*1.1) + 9*sum(j$(b(j) ge 20), buy(j)) + 30*sum(j$(b(j) lt 20), buy(j));
sup(i)$sum((j,k)$link(i,j,k), 1)..   sum((j,k)$link(i,j,k), x(i,j,k)) =l= a(i);
dem(j)..    sum((i,k)$link(i,j,k), x(i,j,k)) + buy(j) =g= b(j);
railcap(i)$(smax(j, d(i,j)) > 3).. sum(link(i,j,'rail'), x(link)) =l= 15;
fair..      sum((i,j,k)$(link(i,j,k) and d(i,j) > 2), x(i,j,k)) =l= 0.7*sum(link, x(link));
never(none).. sum(j, buy(j)) =l= 1;
model ta / all - obj2 /, tb / all - obj - fair /;
solve ta using lp min cost;
b(j) = 1.2*b(j); a('i1') = 30;
solve tb using lp min cost;
solve ta using lp min cost;
x.up(i,j,'truck') = 12;
solve ta using lp min cost;
