$title Producers with nested CES functions, calibrated shares
sets s 'sectors' / food, steel /, f / lab, cap, en /, va(f) / lab, cap /;
alias (f,ff);
parameters sig(s) / food .8, steel 1.4 /, rho(s), del(s,f), theta(s), w(f) / lab 1, cap 1.1, en .7 /, q0(s) / food 10, steel 8 /, end(f) / lab 12, cap 9, en 8 /;
rho(s) = (sig(s) - 1)/sig(s);
del(s,'lab') = .5 + .1$sameas(s,'food'); del(s,'cap') = 1 - del(s,'lab'); theta(s) = .7;
positive variables x(s,f), v(s), q(s); variable cost;
equations nest(s), top(s), market(f), out(s), total;
nest(s)..   v(s) =e= sum(va, del(s,va)*x(s,va)**rho(s))**(1/rho(s));
top(s)..    q(s) =e= 2.2*v(s)**theta(s)*x(s,'en')**(1 - theta(s));
market(f).. sum(s, x(s,f)) =l= end(f);
out(s)..    q(s) =g= q0(s);
total..     cost =e= sum((s,f), w(f)*x(s,f)*(1 + 0.02*x(s,f)/end(f)));
x.lo(s,f) = .01; v.lo(s) = .01; x.l(s,f) = 3; v.l(s) = 3; q.l(s) = q0(s);
model ces / all /;
solve ces using nlp minimizing cost;
