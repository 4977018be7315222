* bmod only: equations that form a network: which of them may be relaxed is not looked for along all ways through it
*= m.modelstat 8
*= pumps 1
set t / t1*t16 /, k / k1*k3 /;
parameter need(t), price(t);
need(t) = 30 + 20*sin(ord(t)/4);
price(t) = 1 + 0.5$(ord(t) > 8);
binary variable on(k,t);
positive variables q(k,t), v(t);
variables h(t), cost;
v.lo(t) = 20;  v.up(t) = 120;  q.up(k,t) = 40;  h.up(t) = 100;  h.lo(t) = 20;
equations pay, tank(t), head(t), curve(k,t), off(k,t);
pay..        cost =e= sum((k,t), price(t)*(4*on(k,t) + 0.1*q(k,t)));
tank(t)..    v(t) =e= (v(t-1) + 60$(ord(t) = 1)) + sum(k, q(k,t)) - need(t);
head(t)..    h(t) =e= 40 + v(t)/10 + 0.001*sqr(sum(k, q(k,t)));
curve(k,t).. h(t)*on(k,t) =e= 60*on(k,t) - 0.01*sqr(q(k,t));
off(k,t)..   q(k,t) =l= 40*on(k,t);
model m / all /;
m.nodlim = 1;
solve m using minlp minimizing cost;
scalar pumps;
pumps = 1$(smax((k,t), abs(h.l(t)*on.l(k,t) - 60*on.l(k,t) + 0.01*sqr(q.l(k,t)))) < 1e-6);
