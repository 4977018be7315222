$title Welfare as areas under linear demand curves, trade between regions, quadratic, costs by sums of squares over tuples
sets r / n, s, e /, g / corn, wheat /, m(r,r) / n.s, s.e, n.e /; alias (r,rr);
parameter a(r,g), b(r,g), c(r,g), q(g,g) / corn.corn 2, corn.wheat .3, wheat.wheat 1.5 /; alias (g,gg);
a(r,g) = 20 + 3*ord(r) - ord(g); b(r,g) = 1 + .2*ord(r); c(r,g) = 2 + ord(r)*ord(g);
positive variables d(r,g), s(r,g), x(r,r,g); variable w;
equations bal(r,g), wel, sym(g);
bal(r,g)..   s(r,g) + sum(rr$(m(rr,r) or m(r,rr)), x(rr,r,g) - x(r,rr,g)) =g= d(r,g);
sym(g)..     sum((r,rr)$(m(r,rr)), sqr(x(r,rr,g))) =l= 60;
wel..        w =e= sum((r,g), a(r,g)*d(r,g) - .5*b(r,g)*sqr(d(r,g))) - .5*sum((r,g,gg), q(g,gg)*s(r,g)*s(r,gg)) - sum((r,g), c(r,g)*s(r,g)) - sum((r,rr,g)$(m(r,rr) or m(rr,r)), (1 + .1*x(r,rr,g))*x(r,rr,g));
x.fx(r,rr,g)$(not (m(r,rr) or m(rr,r))) = 0;
d.l(r,g) = 3; s.l(r,g) = 3;
model trade / all /;
solve trade using nlp maximizing w;
