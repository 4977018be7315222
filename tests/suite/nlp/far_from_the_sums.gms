* bmod only. A start that is far from what linear rows ask for: a step of the size of a variable lessens the violation by next to nothing, which
* is no proof that nothing is feasible. Farm land and fertilizer are given in total, and each crop starts with nearly none of them.
set i 'crops' / 1*5 /, l 'inputs' / land, fertilizer /;
table data(i, *)
      scale    delta    share    price    land    fertilizer
1     5.7e6    0.29     0.48     0.35     156     6.6
2     3.2e6    0.30     0.52     0.90     163     4.2
3     2.2e6    0.38     0.19     0.40     143     4.3
4     1.2e6    0.28     0.48     1.10     123     8.2
5     4.6e6    0.34     0.33     0.45     111     3.5;
parameter total(l) / land 1.4e6, fertilizer 1.2e7 /;
variables x(i, l), q(i), profit(i), z;
positive variables x, q, profit;
equations production(i), margin(i), sums(l), objective;
production(i).. q(i) =e= data(i, 'scale')*(data(i, 'share')/x(i, 'land') + (1 - data(i, 'share'))/x(i, 'fertilizer'))**(-data(i, 'delta'));
margin(i)..     profit(i) =e= data(i, 'price')*q(i) - sum(l, data(i, l)*x(i, l));
sums(l)..       sum(i, x(i, l)) =e= total(l);
objective..     z =e= sum(i, profit(i));
x.lo(i, l) = 0.001;
model m / all /;
solve m using nlp maximizing z;
*= m.modelstat 2
scalar first, same;
first = z.l;
x.l(i, l) = total(l)/card(i);
solve m using nlp maximizing z;
same = abs(z.l - first) < 1e-6*z.l;
*= same 1
