$title Design with powers of every kind, min and max over data only, products of variables over tuples, reciprocal sums
sets u 'units' / u1*u4 /, pr 'products' / A, B, C /, can(u,pr); alias (u,v);
can(u,pr) = not (ord(u) = 2 and ord(pr) = 3);
parameters sf(u,pr), tp(u,pr), qd(pr) / A 40, B 60, C 20 /, alpha(u), beta(u);
sf(u,pr)$can(u,pr) = 1 + .2*ord(u) + .1*ord(pr); tp(u,pr)$can(u,pr) = 2 + mod(ord(u)*ord(pr),5); alpha(u) = 250 - 20*ord(u); beta(u) = .5 + .05*ord(u);
positive variables vol(u), n(u), b(pr), tl(pr); variable cost;
equations volume(u,pr), cyc(u,pr), horizon, obj, geo, harm(pr);
volume(u,pr)$can(u,pr)..  vol(u) =g= sf(u,pr)*b(pr);
cyc(u,pr)$can(u,pr)..     n(u)*tl(pr) =g= tp(u,pr);
horizon..   sum(pr, qd(pr)*tl(pr)/b(pr)) =l= 60*max(1, smin(pr, qd(pr))/20);
geo..       prod(u, n(u))**(1/card(u)) =l= 2.5;
harm(pr)..  1/sum(can(u,pr), 1/vol(u)) =g= .3*rpower(b(pr),.5);
obj..       cost =e= sum(u, alpha(u)*n(u)*vol(u)**beta(u)) + sum(pr, power(tl(pr),-2)) + sum(u, vcpower(vol(u),2.5)/1000) + sum(pr, cvpower(1.1,tl(pr)));
vol.lo(u) = 1; vol.up(u) = 50; n.lo(u) = 1; n.up(u) = 4; b.lo(pr) = .5; b.up(pr) = 30; tl.lo(pr) = .5; tl.up(pr) = 12; vol.l(u) = 20; n.l(u) = 2; b.l(pr) = 8; tl.l(pr) = 3;
model batch / all /;
solve batch using nlp minimizing cost;
