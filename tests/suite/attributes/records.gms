* card of a variable counts its records: those of the last solve, and where an attribute is not at its default
set i / 1*6 /;
positive variable x(i);
variable z;
equation e, o, f(i);
o.. z =e= sum(i$(ord(i) < 5), ord(i)*x(i));
e.. x('1') + x('2') =g= 3;
f(i)$(ord(i) < 3).. x(i) =l= 10;
model m / all /;
solve m using lp minimizing z;
scalar solved, rows, bound, zeros, again, cleared;
solved = card(x);
rows = card(f);
x.up('6') = 4;
bound = card(x);
x.l(i) = 0;
x.m(i) = 0;
zeros = card(x);
x.l(i)$(ord(i) > 3) = 2;
x.l(i) = 0;
again = card(x);
option clear = x;
cleared = card(x);
*= solved 4
*= rows 2
*= bound 5
*= zeros 1
*= again 1
*= cleared 0
