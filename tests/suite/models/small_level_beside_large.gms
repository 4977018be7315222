* bmod only: a level of 2e-5 beside one of 1e10 is no rounding error, nor is it in an mcp.

*= m.modelstat 1
*= y.l 0.00002
*= n.modelstat 1
*= v.l 0.00002
positive variables x, y, u, v;
variable z;
equations o, a, b, c, d;
o.. z =e= x + 1000*y;
a.. x =g= 1e10;
b.. y =g= 2e-5;
c.. u =g= 1e10;
d.. v =g= 2e-5;
model m / o, a, b /;
model n / c.u, d.v /;
solve m using lp minimizing z;
solve n using mcp;
