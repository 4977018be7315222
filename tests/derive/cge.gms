$title A small general equilibrium: Cobb-Douglas by prod, CET and Armington, calibration from an accounting matrix, numeraire fixed
set u 'all accounts' / brd, mlk, cap, lab, hoh, idt /, i(u) / brd, mlk /, h(u) / cap, lab /; alias (u,v), (i,j), (h,k);
table sam(u,v)
        brd   mlk   cap   lab   hoh   idt
 brd     21     8                20
 mlk     17     9                33
 cap     10    15
 lab      1    27
 hoh                 25    28             ;
parameters x0(i), f0(h,j), y0(j), z0(j), ax(i,j), ay(j), beta(h,j), b(j), alpha(i), ff(h), m0(i), e0(i), gam(i), del(i), eta / .5 /;
f0(h,j) = sam(h,j); y0(j) = sum(h, f0(h,j)); z0(j) = y0(j) + sum(i, sam(i,j)); x0(i) = sam(i,'hoh'); ff(h) = sum(j, f0(h,j));
ax(i,j) = sam(i,j)/z0(j); ay(j) = y0(j)/z0(j); beta(h,j) = f0(h,j)/sum(k, f0(k,j)); b(j) = y0(j)/prod(h, f0(h,j)**beta(h,j)); alpha(i) = x0(i)/sum(j, x0(j));
positive variables y(j), f(h,j), x(i), z(j), xi(i,j), pf(h), pz(i), py(j); variable uu, ls; 
equations eqy(j), eqf(h,j), eqxi(i,j), eqz(j), eqx(i), eqpz(j), mkt(i), fac(h), obj;
eqy(j)..    y(j) =e= b(j)*prod(h, f(h,j)**beta(h,j));
eqf(h,j)..  f(h,j) =e= beta(h,j)*py(j)*y(j)/pf(h);
eqxi(i,j).. xi(i,j) =e= ax(i,j)*z(j);
eqz(j)..    y(j) =e= ay(j)*z(j);
eqx(i)..    x(i) =e= alpha(i)*sum(h, pf(h)*ff(h))/pz(i);
eqpz(j)..   pz(j) =e= ay(j)*py(j) + sum(i, ax(i,j)*pz(i));
mkt(i)..    z(i) =g= x(i) + sum(j, xi(i,j)) + ls$(ord(i) = 1);
fac(h)..    sum(j, f(h,j)) =l= ff(h);
obj..       uu =e= prod(i, x(i)**alpha(i)) - sqr(ls);
y.l(j) = y0(j); f.l(h,j) = f0(h,j); x.l(i) = x0(i); z.l(j) = z0(j); xi.l(i,j) = sam(i,j); pf.l(h) = 1; pz.l(i) = 1; py.l(j) = 1;
y.lo(j) = .01; f.lo(h,j) = .01; x.lo(i) = .01; z.lo(j) = .01; pf.lo(h) = .01; pz.lo(i) = .01; py.lo(j) = .01;
pf.fx('lab') = 1;
model cge / all /; cge.holdfixed = 1; cge.workspace = 8; 
option nlp = ipopt, decimals = 4;
solve cge maximizing uu using nlp;
