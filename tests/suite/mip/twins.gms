* Columns whose rows are the same but for them, for both directions of a line, say, have the same value in some best solution:
* the search does not look at them one by one.
set n / n1*n6 /, k / k1*k3 /;  alias(n,m);
parameter demand(n) / n1 -9, n2 4, n3 2, n4 1, n5 -3, n6 5 /;
set line(n,m);  line(n,m) = ord(m) = ord(n)+1 or ord(m) = ord(n)+3;
line(n,m)$line(m,n) = yes;
parameter price(n,m);  price(n,m)$line(n,m) = 7 + mod(3*min(ord(n),ord(m)) + 5*max(ord(n),ord(m)), 6);
variables f(n,m,k), cost, works;  binary variables build(n,m,k);
equations balance(n), twoway(n,m,k), most(n,m,k), least(n,m,k), total, parts;
balance(n).. sum((m,k)$line(n,m), f(n,m,k)) =e= -demand(n);
twoway(n,m,k)$(line(n,m) and ord(n) < ord(m)).. f(n,m,k) + f(m,n,k) =e= 0;
most(n,m,k)$line(n,m).. f(n,m,k) =l= 3*build(n,m,k);
least(n,m,k)$line(n,m).. f(n,m,k) =g= -3*build(n,m,k);
* What works cost has a name of its own, as in many models; the search knows what each part of it costs all the same.
parts.. cost =g= 2*works + 1;
total.. works =e= sum((n,m,k)$line(n,m), (price(n,m) + 0.1*ord(k))*build(n,m,k));
model network / all /;
option optcr = 0;
solve network using mip minimizing cost;
*= network.modelstat 1
scalar differ;  differ = sum((n,m,k)$line(n,m), abs(build.l(n,m,k) - build.l(m,n,k)));
*= differ 0
abort$(network.nodusd > 500) 'each direction is branched on by itself';
