$title Products over conditions, powers with data, abs of data
set w / icbm, bomb, tact /, t / 1*5 /;
table td(w,t)
          1     2     3     4     5
 icbm    .05         .16   .04
 bomb          .08         .10   .06
 tact    .11   .02   .13         .09 ;
parameter wa(w) / icbm 20, bomb 15, tact 30 /, tm(t) / 1 3, 3 4 /, mv(t) / 1 60, 2 50, 3 50, 4 75, 5 40 /;
positive variable x(w,t); variable prob(t), tetd, etd;
equations maxw(w), minw(t), probe(t), etdp, etdf;
maxw(w)..        sum(t$td(w,t), x(w,t)) =l= wa(w);
minw(t)$tm(t)..  sum(w$td(w,t), x(w,t)) =g= tm(t);
probe(t)..       prob(t) =e= 1 - prod(w$td(w,t), (1 - td(w,t))**x(w,t));
etdp..           tetd =e= sum(t, mv(t)*prob(t));
etdf..           etd =e= sum(t, mv(t)*(1 - prod(w$td(w,t), (1 - td(w,t))**x(w,t))));
x.l(w,t)$td(w,t) = wa(w)/5;
model war1 / maxw, minw, probe, etdp /, war2 / maxw, minw, etdf /;
solve war1 maximizing tetd using nlp;
solve war2 maximizing etd using nlp;
