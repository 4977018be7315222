* A convex program without a solution: `bmod why` names the rows and bounds that contradict each other, and no others.
* The point is at least 3 away, and the rope is 2 long; the other rows have nothing to do with it.
set i / 1*3 /;
positive variable rope;  variables x, y, z, w(i);
equations cost, reach, far, short, others(i), sum_of;
cost..    z =e= rope + sum(i, w(i));
reach..   sqr(rope) =g= sqr(x) + sqr(y - 1);
far..     x - y =g= 4;
short..   rope =l= 2;
others(i).. w(i) =g= exp(x);
sum_of..  sum(i, w(i)) =l= 1000;
y.up = 50;  x.up = 60;
model m / all /;
solve m using nlp minimizing z;
*= m.modelStat 4
*? irreducible 4
*? why reach
*? why far
*? why short
*? why rope
