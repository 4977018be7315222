* A direction of a cone leads down without limit, and rows far out have large slopes: no optimum is claimed there.
variables z, x, y, t, w;
equations total, cone, sum_of_both, wave;
t.lo = 0;
w.lo = -2;
w.up = 2;
total..       z =e= t - 1.9*x - 0.3*y + w*w*w*w - 2*w*w*w + w;
cone..        sqr(t) =g= sqr(x) + sqr(y);
sum_of_both.. x + y =l= 1;
wave..        x - 0.1*sin(w) =g= -5;
model m / all /;
solve m using nlp minimizing z;
*= m.modelStat 3
