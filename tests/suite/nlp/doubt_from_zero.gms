* bmod only: all levels are 0, products of flows and shares have no slopes there, and bounds are far away: linear programs
* prove that nothing near the start is feasible. From where the linear rows hold, near 1, a solution is found.
set s 'streams' / s1*s3 /, t 'treatments' / t1*t3 /, c 'contaminants' / a, b /;
alias (t, v);
parameter f(s) / s1 20, s2 15, s3 5 /, limit(c) / a 4000, b 2000 /;
table load(s,c)
         a      b
  s1 12000   6000
  s2 10000   3000
  s3 10000   1500;
table rest(t,c) 'what a treatment leaves'
         a      b
  t1  0.01   1.00
  t2  0.20   0.30
  t3  0.60   0.05;
positive variables share(s,t) 'of a stream', last(s) 'of a stream to the end', e(t,v) 'of what leaves a treatment', o(t) 'of it to the end',
  q(t) 'flow', g(t,v) 'flow on', h(t) 'flow to the end', m(t,c) 'mass in', w(t,v,c) 'mass on', d(t,c) 'mass to the end';
q.up(t) = 1e6; g.up(t,v) = 1e6; h.up(t) = 1e6; m.up(t,c) = 1e6; w.up(t,v,c) = 1e6; d.up(t,c) = 1e6;
share.up(s,t) = 1e6; last.up(s) = 1e6; e.up(t,v) = 1e6; o.up(t) = 1e6;
variable cost;
equations total, parts(s), out(t), flow(t), on(t,v), end(t), mass(t,c), masson(t,v,c), massend(t,c), discharge(c);
total..         cost =e= sum(t, q(t));
parts(s)..        sum(t, share(s,t)) + last(s) =e= 1;
out(t)..        sum(v$(not sameas(t,v)), g(t,v)) + h(t) =e= q(t);
flow(t)..       q(t) =e= sum(s, f(s)*share(s,t)) + sum(v$(not sameas(t,v)), g(v,t));
on(t,v)$(not sameas(t,v))..         g(t,v) =e= e(t,v)*q(t);
end(t)..        h(t) =e= o(t)*q(t);
mass(t,c)..     m(t,c) =e= sum(s, load(s,c)*share(s,t)) + sum(v$(not sameas(t,v)), w(v,t,c));
masson(t,v,c)$(not sameas(t,v))..   w(t,v,c) =e= rest(t,c)*e(t,v)*m(t,c);
massend(t,c)..  d(t,c) =e= rest(t,c)*o(t)*m(t,c);
discharge(c)..  sum(s, load(s,c)*last(s)) + sum(t, d(t,c)) =l= limit(c);
model water / all /;
solve water using nlp minimizing cost;
*= water.modelstat 2
*= cost.l 57.74875621890547
