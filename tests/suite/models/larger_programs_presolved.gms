* Programs so large that they are presolved, of which nothing is left when what is decided is taken out: rows of one column,
* equations in two, chains; and what has no point or no bound at all is said of the program as given.
set i / i1*i400 /;
variable z, x(i), y(i);
positive variable p(i);
equation cost, least(i), most(i), chain(i), twice(i), over(i);
least(i).. 2*x(i) =g= ord(i);
most(i)..  x(i) =l= 500;
cost..     z =e= sum(i, x(i)) + sum(i, y(i));
twice(i).. y(i) - 3*x(i) =e= 1;
model decided / cost, least, most, twice /;
solve decided using lp minimizing z;
scalar a, c, d, slope;
a = z.l;
slope = least.m('i7');
*= decided.modelstat 1
*= a 160800
*= slope 2
chain(i).. x(i) - x(i-1) - p(i) =e= 1;
model linked / cost, twice, chain, most /;
y.lo(i) = 0;
solve linked using lp minimizing z;
c = p.l('i9');
*= linked.modelstat 1
*= c 0
* x('i1') = 1 − …: y ≥ 0 holds x above −1/3, and all others follow.
over(i).. x(i) + y(i) =g= 3000 + ord(i);
solve decided using lp maximizing z;
d = z.l;
* 500 each, and y = 1501.
*= d 800400
model against / cost, twice, most, over /;
solve against using lp minimizing z;
*= against.modelstat 4
model endless / cost, twice /;
solve endless using lp maximizing z;
*= endless.modelstat 3
