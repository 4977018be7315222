* What all points of an equation have in common holds: an activity that lasts d periods begins and ends once, so its start
* says when it ends, and what cannot be in time is out before any search.
set a / a1*a6 /, t / 0*22 /;  alias(a,b), (t,u);
parameter d(a) / a1 4, a2 3, a3 5, a4 6, a5 4, a6 3 /, w(a) / a1 3, a2 4, a3 2, a4 2, a5 3, a6 1 /;
set before(a,b) / a1.(a3,a4), a2.a4, a3.a5, a4.a6 /;
binary variables works(a,t), starts(a,t), ends(a,t), busy(t);  variable makespan;
equations long, any(t), lasts(a), crew(t), state(a,t), once(a), over(a), order(a,b,t);
long.. makespan =e= sum(t, busy(t));
any(t).. sum(a, works(a,t)) =l= 6*busy(t);
lasts(a).. sum(t, works(a,t)) =e= d(a);
crew(t).. sum(a, w(a)*works(a,t)) =l= 5;
state(a,t).. works(a,t) =e= works(a,t-1) + starts(a,t) - ends(a,t);
once(a).. sum(t, starts(a,t)) =e= 1;
over(a).. sum(t, ends(a,t)) =e= 1;
order(a,b,t)$before(a,b).. starts(b,t) =l= sum(u$(ord(u) <= ord(t)), ends(a,u));
model schedule / all /;
option optcr = 0;
solve schedule using mip minimizing makespan;
*= schedule.modelstat 1
scalar late;  late = sum(a, sum(t, ord(t)*(ends.l(a,t) - starts.l(a,t))) - d(a));
*= late 0
abort$(schedule.nodusd > 1000) 'starts and ends are branched on by themselves';
