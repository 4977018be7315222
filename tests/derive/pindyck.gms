$title A cartel over time: lags with initial labels, objective by discounting, definitions chained by lags
set t / 1974*1990 /, to(t); to(t) = yes$(ord(t) > 1);
positive variables p(t), td(t), s(t), cs(t), d(t), r(t), rev(t); variable profit;
p.lo(t) = .5;
equations tdeq(t), seq(t), cseq(t), deq(t), req(t), drev(t), tprofit;
parameter demand(t); demand(t) = 1 + 2.3*1.015**(ord(t) - 1);
tdeq(to(t))..  td(t) =e= .87*td(t-1) - .13*p(t) + demand(t-1);
seq(to(t))..   s(t) =e= .75*s(t-1) + (1.1 + .1*p(t))*1.02**(-cs(t)/7);
cseq(to(t))..  cs(t) =e= cs(t-1) + s(t);
deq(to(t))..   d(t) =e= td(t) - s(t);
req(to(t))..   r(t) =e= r(t-1) - d(t);
drev(to(t))..  rev(t) =e= d(t)*(p(t) - 250/r(t));
tprofit..      profit =e= sum(to(t), rev(t)*1.05**(1 - ord(t)));
td.fx('1974') = 18; s.fx('1974') = 6.5; r.fx('1974') = 500; cs.fx('1974') = 0;
td.l(t) = 18; s.l(t) = 7; cs.l(t) = 7*ord(t); d.l(t) = td.l(t) - s.l(t); p.l(t) = 14; rev.l(t) = 90; r.l(t) = 500 - 8*ord(t); r.lo(t) = 50;
model robert / all /;
solve robert maximizing profit using nlp;
