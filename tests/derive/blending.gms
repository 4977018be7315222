$Title Blending of oils with quality limits given only for some products
Sets c 'crudes' / light, medium, heavy /, g 'products' / regular, premium, fuel /, q 'qualities' / octane, sulfur, density /,
     lim / min, max /;
Table prop(c,q)
          octane sulfur density
  light     92    0.3     0.7
  medium    86    0.8     0.8
  heavy     78    1.9     0.9;
Table spec(g,q,lim)
                    min    max
  regular.octane    84
  premium.octane    88
  regular.sulfur           1.0
  premium.sulfur           0.6
  fuel.density      0.78   0.95 ;
Parameter avail(c) / light 60, medium 100, heavy 90 /, pc(c) / light 48, medium 41, heavy 33 /, pg(g) / regular 55, premium 60, fuel 42 /;
Positive variables b(c,g), y(g); Variable profit; Negative Variable short(c);
Equations qmin(g,q), qmax(g,q), sum1(g), use(c), def;
qmin(g,q)$spec(g,q,'min')..  sum(c, prop(c,q)*b(c,g)) =g= spec(g,q,'min')*y(g);
qmax(g,q)$spec(g,q,'max')..  sum(c, prop(c,q)*b(c,g)) =l= spec(g,q,'max')*y(g);
sum1(g)..  y(g) =e= sum(c, b(c,g));
use(c)..   sum(g, b(c,g)) + short(c) =l= avail(c);
def..      profit =e= sum(g, pg(g)*y(g)) - sum((c,g), pc(c)*b(c,g)) + sum(c, 70*short(c));
y.lo('fuel') = 10;  y.up(g) = 90;  short.lo(c) = -15;
y.scale(g) = 10;
Model oil / all /; oil.scaleopt = 1;
solve oil using lp max profit;
scalar tot; tot = sum(g, y.l(g));
display tot, use.m;
