* The benchmark test of many equilibrium models: no iterations, and then the sum of what the rows of unsolved pairs are off by.
variables x, y, p;
positive variables x, y;
equations f, g, h;
f..  x + p =g= 2;
g..  2*y =g= 8;
h..  p =e= 1;
model m / f.x, g.y, h.p /;
m.iterlim = 0;
x.l = 4;  y.l = 0;  p.l = 1;
solve m using mcp;
parameter off(*);
off('number') = m.numInfes;  off('sum') = m.sumInfes;  off('largest') = m.maxInfes;  off('mean') = m.meanInfes;
* f is slack by 3 and x is not at its bound; g lacks 8; h holds
*= off('number') 2
*= off('sum') 11
*= off('largest') 8
*= off('mean') 5.5
x.l = 1;  y.l = 4;
solve m using mcp;
*= m.modelstat 1
*= m.numInfes 0
*= m.sumInfes 0
