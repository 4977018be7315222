* bmod only: `option qcp = clarabel` is Clarabel or an error, never another solver: cones, then a bilinear row.
*! execution 20
variables x, y, t, z;
equations total, cone, product;
total..   z =e= t - 0.5*x;
cone..    sqr(t) =g= sqr(x - 1) + sqr(y - 2);
product.. x*y =g= 1;
t.lo = 0;
x.up = 4;
y.up = 4;
model convex / total, cone /;
option qcp = clarabel;
solve convex using qcp minimizing z;
*= known 1
*= value -0.5
scalars known, value;
known = convex.modelStat;
value = round(z.l, 6);
model bilinear / all /;
solve bilinear using qcp minimizing z;
