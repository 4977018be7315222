$title Estimation: likelihood with errorf and exp, data by table, signed powers
set i / 1*10 /, p / mu, sg, k /; 
parameter y(i), cens(i);
y(i) = 1.2 + 0.9*sin(3*ord(i)) + 0.1*ord(i); cens(i) = 1$(mod(ord(i),4) = 0);
variables th(p), like, q(i); 
equations def, qd(i), order;
qd(i)..   q(i) =e= (y(i) - th('mu') - th('k')*ord(i))/th('sg');
def..     like =e= sum(i$(not cens(i)), -log(th('sg')) - 0.5*log(2*pi) - power(q(i),2)/2) + sum(i$cens(i), log(1 - errorf(q(i)) + 1e-12));
order..   signpower(th('mu'),3) + entropy(th('sg')) =g= -5;
th.lo('sg') = 0.1; th.l('sg') = 1; th.l('mu') = 1; th.up('k') = 0.5; th.lo('k') = -0.5;
model ml / all /;
solve ml maximizing like using nlp;
