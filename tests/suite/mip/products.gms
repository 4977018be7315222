* Products with a binary factor become linear, and the answer is proved. GAMS's SBB says 8 and may stop at worse points.
set i /1*5/, k /a, b/;
alias(i, j, jj);
set e(i, j) / 1.2, 2.3, 3.4, 4.5, 1.5 /;
parameter w(i) / 1 8, 2 6, 3 5, 4 3, 5 4 /, d(i, j);
d(i, j) = abs(ord(i) - ord(j))*(1 + mod(ord(i)*ord(j), 3));
binary variables x(i), p(i, j), on(k);
positive variable y(k);
variables z;
equations cut, sack, room, place, one(i), each(j), pay, use(k), cube, square, bad;
cut..  z =e= sum(e(i, j), x(i)*(1 - x(j)) + x(j)*(1 - x(i)));
sack..  z =e= sum((i, j), x(i)*w(i)*w(j)*x(j)) - 60*sum(i, x(i));
room..  sum(i, w(i)*x(i)) =l= 16;
place..  z =e= sum((i, j, jj), d(i, '1')*d(j, jj)*p(i, j)*p('1', jj)) + sum((i, j)$(ord(i) > 1), d(i, j)*p(i, j)*p(i--1, j--1));
one(i)..  sum(j, p(i, j)) =e= 1;
each(j)..  sum(i, p(i, j)) =e= 1;
pay..  z =e= sum(k, y(k)*(5 - 3*on(k)) + 7*on(k)*on('a'));
use(k)..  on(k)*y(k) =g= 2;
cube..  z =e= x('1')*x('2')*x('3') + 2*x('1')*x('2')*y('a') - x('3') - power(x('1') + x('2'), 3);
square..  z =e= sum(i, sqr(x(i)) - 3*sqr(x(i) - 1)*x('1')) + x('2');
bad..  x('1')*x('2') =g= 2;
model cuts / cut /, sacks / sack, room /, places / place, one, each /, pays / pay, use /, cubes / cube, room /, squares / square /, none / square, bad /;
y.up(k) = 4;
option optCR = 0;
solve cuts using miqcp maximizing z;
*= cuts.modelstat 1
*= cuts.objval 4
solve sacks using miqcp maximizing z;
*= sacks.modelstat 1
*= sacks.objval 76
solve places using miqcp minimizing z;
*= places.modelstat 1
*= places.objval 28
solve pays using miqcp minimizing z;
*= pays.modelstat 1
*= pays.objval 22
solve cubes using minlp maximizing z;
*= cubes.modelstat 1
*= cubes.objval 0
solve squares using miqcp minimizing z;
*= squares.modelstat 1
*= squares.objval -11
solve none using miqcp minimizing z;
*= none.modelstat 4

* Products of two integers: patterns to cut rolls by, and how often each is cut.
set width /1*3/, pattern /1*3/;
parameter wide(width) /1 330, 2 360, 3 430/, wanted(width) /1 9, 2 7, 3 6/;
integer variables often(pattern), cuts1(width, pattern);
often.up(pattern) = 12;
cuts1.up(width, pattern) = 5;
equations rolls, enough(width), fits(pattern), knives(pattern), twice, apart;
rolls..  z =e= sum(pattern, often(pattern));
enough(width)..  sum(pattern, often(pattern)*cuts1(width, pattern)) =g= wanted(width);
fits(pattern)..  sum(width, wide(width)*cuts1(width, pattern)) =l= 1900;
knives(pattern)..  sum(width, cuts1(width, pattern)) =l= 5;
twice..  z =e= sqr(often('1') - 3)*often('2') - 5*often('1')*often('2') + 0.5*often('1');
apart..  often('1') =g= 2;
model trim / rolls, enough, fits, knives /, powers / twice, apart /;
solve trim using minlp minimizing z;
*= trim.modelstat 1
*= trim.objval 5
often.lo(pattern) = -3;
solve powers using minlp minimizing z;
*= powers.modelstat 1
*= powers.objval -249.5
