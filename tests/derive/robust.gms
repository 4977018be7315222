$title Norms and log-sums: sqrt of quadratic forms, log of sums of exp, a model inside if, data changed by the answer of another
set i / 1*4 /, k / 1*3 /; alias (i,j);
parameter mu(i), l(i,k), cap / .6 /; mu(i) = .03 + .02*ord(i); l(i,k) = (mod(ord(i)*ord(k) + ord(i),4) - 1)/10;
positive variable x(i); variables ret, worst;
equations one, soft, rob, lim(i), ob;
one..   sum(i, x(i)) =e= 1;
rob..   ret =l= sum(i, mu(i)*x(i)) - .5*sqrt(1e-4 + sum(k, sqr(sum(i, l(i,k)*x(i)))));
soft..  worst =e= .1*log(sum(i, exp(x(i)/.1)));
lim(i)$(ord(i) <> 2).. x(i) =l= cap;
ob..    worst =l= .55 + .1*log(card(i));
x.l(i) = .25;
model m1 / one, rob, lim /, m2 / one, rob, soft, ob /;
solve m1 maximizing ret using nlp;
if(ret.l > 0, cap = .4; x.l(i) = .25; solve m2 maximizing ret using nlp; else cap = .9;);
