* Node limit, cutoff and gap.
set i / 1*20 /, k / 1*4 /;
parameters w(k,i), c(i), b(k);
w(k,i) = 5 + mod(ord(i)*37 + ord(k)*53 + ord(i)*ord(k)*11, 89);
c(i) = sum(k, w(k,i))/4 + mod(ord(i)*29, 31);
b(k) = floor(sum(i, w(k,i))/2);
binary variable x(i);
free variable z;
equations value, room(k);
value..    z =e= sum(i, c(i)*x(i));
room(k)..  sum(i, w(k,i)*x(i)) =l= b(k);
model m / all /;
m.optCR = 0;
solve m using mip maximizing z;
scalar best, first;
best = z.l;
first = m.modelstat;
*= first 1
m.cutoff = best + 1;
solve m using mip maximizing z;
scalar none;
none = m.modelstat;
*= none 10
m.cutoff = best - 0.01;
solve m using mip maximizing z;
scalar again;
again = z.l - best;
*= again 0
m.cutoff = na;
m.optCR = 0.5;
solve m using mip maximizing z;
scalar near;
near = m.modelstat;
*= near 8
