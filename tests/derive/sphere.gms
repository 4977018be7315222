$title Points on a sphere: ordered pairs by ord, dimensions as labels, repulsion; maximum of the smallest distance
set i / i1*i7 /, d / x, y, z /; alias (i,j);
set ut(i,i); ut(i,j) = ord(j) > ord(i);
variables p(i,d), pot, dmin, dd(i,i); positive variable dd;
equations ball(i), ener, dist(i,j), least(i,j), far, fix;
ball(i)..        sum(d, sqr(p(i,d))) =e= 1;
ener..           pot =e= sum(ut(i,j), 1/sqrt(sum(d, sqr(p(i,d) - p(j,d)))));
dist(ut(i,j))..  dd(ut) =e= sqrt(sum(d, power(p(i,d) - p(j,d),2)));
least(ut)..      dmin =l= dd(ut);
far..            dmin =l= 2;
fix..            p('i1','x') =e= 1 - p('i1','y')*p('i1','z');
p.lo(i,d) = -1; p.up(i,d) = 1; dd.lo(ut) = .05;
p.l(i,'x') = cos(2*pi*ord(i)/card(i)); p.l(i,'y') = sin(2*pi*ord(i)/card(i)); p.l(i,'z') = (ord(i) - 4)/10; dd.l(ut) = .6; dmin.l = .3;
model thomson / ball, ener, fix /, tammes / ball, dist, least, far /;
solve thomson using nlp minimizing pot;
solve tammes using nlp maximizing dmin;
