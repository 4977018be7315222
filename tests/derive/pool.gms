$title Pooling with bilinear quality, proportions, tuple sets for connections
sets s / s1*s3 /, p / p1, p2 /, t / t1, t2 /, sp(s,p) / s1.p1, s2.p1, (s2,s3).p2 /, pt(p,t) / p1.t1, p1.t2, p2.t2 /, st(s,t) / s3.t1 /;
parameters cs(s) / s1 6, s2 16, s3 10 /, qs(s) / s1 3, s2 1, s3 2 /, pt0(t) / t1 9, t2 15 /, qt(t) / t1 2.5, t2 1.5 /, dt(t) / t1 100, t2 200 /;
positive variables y(s,p), f(p,t), z(s,t), q(s,p); variable cost;
equations share(p), flow(s,p), qual(t), dem(t), link(s,p,t), obj;
positive variable v(s,p,t);
share(p)..        sum(sp(s,p), q(sp)) =e= 1;
link(s,p,t)$(sp(s,p) and pt(p,t))..  v(s,p,t) =e= q(s,p)*f(p,t);
flow(sp(s,p))..   y(s,p) =e= sum(pt(p,t), v(s,p,t));
qual(t)..         sum((sp(s,p))$pt(p,t), qs(s)*v(s,p,t)) + sum(st(s,t), qs(s)*z(st)) =l= qt(t)*(sum(pt(p,t), f(pt)) + sum(st(s,t), z(s,t)));
dem(t)..          sum(pt(p,t), f(p,t)) + sum(s$st(s,t), z(s,t)) =l= dt(t);
obj..             cost =e= sum(sp(s,p), cs(s)*y(sp)) + sum(st(s,t), cs(s)*z(st)) - sum(t, pt0(t)*(sum(pt(p,t), f(p,t)) + sum(st(s,t), z(s,t))));
q.l(s,p) = 0.5; f.l(p,t) = 40; f.up(p,t) = 300; q.up(sp) = 1;
model pool / all /;
solve pool using nlp minimizing cost;
