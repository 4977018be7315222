* bmod only: what objEst and nodUsd say: cheat leaves a gap, nothing is known without convexity or a solution, and what needs no search is its own bound.
set i / 1*3 /;
binary variable x(i);
integer variables p, q;
variables z, y;
q.up = 3;
p.fx = 2;
y.lo = -3;
y.up = 3;
equations o, c, none, first, n;
o..  z =e= 5*x('1') + 4*x('2') + 3*x('3');
c..  2*x('1') + 3*x('2') + x('3') =l= 3;
none..  2*x('1') + 2*x('2') =e= 1;
first..  z =e= 3*p;
n..  z =e= sqr(y - 1)*sin(3*y) + q;
model m / o, c /, empty / o, c, none /, fixed / first /, wavy / n /;
option optCR = 0;
* HiGHS knows no cheat: in a build with it this is asked of the own search.
option mip = bmip;
m.cheat = 10;
m.tryInt = 0.1;
x.l('2') = 1;
solve m using mip maximizing z;
*= m.modelstat 8
*= m.objest 14
solve empty using mip maximizing z;
*= empty.modelstat 10
*= empty.objest na
solve fixed using mip maximizing z;
*= fixed.objest 6
*= fixed.nodusd 0
solve wavy using minlp minimizing z;
*= wavy.modelstat 8
*= wavy.objest na
