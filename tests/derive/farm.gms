$title A farm model: crops in sequences, labour by periods, risk by deviations, equation with a data-dependent relation of sets
sets c 'crops' / wheat, clover, beans, onions, cotton /, p 'periods' / jan, feb, mar, apr, may, jun, jul, aug, sep, oct, nov, dec /, s 'states' / s1*s6 /,
     sc(c) 'sold' / wheat, beans, onions, cotton /, winter(p) / nov, dec, jan, feb /, seq(c,c) / wheat.cotton, clover.beans, onions.beans /;
alias (c,cc), (p,pp);
table land(p,c)
       wheat clover beans onions cotton
 jan     1      1     1      1
 feb     1      1     1      1
 mar     1     .5     1      1     .5
 apr     1            1      1      1
 may     1           .25    .25     1
 jun                                1
 jul                                1
 aug                                1
 sep                                1
 oct                                1
 nov    .5      1    .25    .5    .75
 dec     1      1     1      1        ;
table lab(p,c)
       wheat clover beans onions cotton
 jan   1.72   4.5    .75   5.16
 feb    .5     1     .75    5
 mar    1      8     .75    5       5
 apr    1            16    19.58    5
 may   17.16        2.42            9
 jun   2.34                         2
 jul                              1.5
 nov   2.43   2.5    9     11    11.16
 dec   1.35   7.5   1.88   5        ;
parameter yld(c) / wheat 1.5, clover 6.5, beans 1, onions 6, cotton 1.5 /, price(c) / wheat 100, beans 200, onions 125, cotton 350 /, dev(s,c);
dev(s,sc) = price(sc)*yld(sc)*(mod(7*ord(s) + 3*ord(sc),9) - 4)/20;
positive variables xc(c), flab(p), tlab(p), neg(s), buy(c); variable yfarm;
equations lb(p), ll(p), risk(s), avg, obj, rot(c,c), feed;
lb(p)..   sum(c, xc(c)*land(p,c)) =l= 10;
ll(p)..   sum(c, xc(c)*lab(p,c)) =l= flab(p) + tlab(p)$(not winter(p));
risk(s).. sum(sc, dev(s,sc)*xc(sc)) + neg(s) =g= 0;
avg..     sum(s, neg(s))/card(s) =l= 150;
rot(seq(c,cc))..  xc(cc) =l= xc(c) + 2;
feed..    yld('clover')*xc('clover') + buy('clover') =g= 10;
obj..     yfarm =e= sum(sc, price(sc)*yld(sc)*xc(sc)) - sum(p, 3*flab(p) + 6*tlab(p)) - 40*buy('clover');
flab.up(p) = 25; buy.fx(c)$(not sameas(c,'clover')) = 0;
model farm / all /;
solve farm using lp maximizing yfarm;
parameter shadow(*,p); shadow('land',p) = lb.m(p); shadow('labour',p) = ll.m(p);
display shadow, xc.l;
