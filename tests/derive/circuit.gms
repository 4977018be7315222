$title Trigonometric and hyperbolic functions, ifthen over data, division by sums, objective variable with a factor
set b / b1*b4 /, line(b,b) / b1.b2, b2.b3, b3.b4, b1.b4 /; alias (b,bb);
parameter g(b,b), bs(b,b), pd(b) / b2 .5, b3 .7, b4 .3 /, typ(b) / b1 1, b3 2 /;
g(line) = 1.2; bs(line(b,bb)) = -5 - ord(b); g(b,bb)$line(bb,b) = g(bb,b); bs(b,bb)$line(bb,b) = bs(bb,b);
set con(b,b); con(b,bb) = line(b,bb) or line(bb,b);
variables vm(b), va(b), pg(b), obj; positive variable pg;
equations pf(b), cost, ang(b,b), shape(b);
pf(b)..     pg(b) - pd(b) =e= sum(bb$con(b,bb), vm(b)*vm(bb)*(-g(b,bb)*cos(va(b) - va(bb)) + bs(b,bb)*sin(va(b) - va(bb))*(-1)) + g(b,bb)*sqr(vm(b)));
ang(line(b,bb)).. tan(va(b) - va(bb)) =l= 0.6;
shape(b)..  ifthen(typ(b) = 1, cosh(va(b)), tanh(vm(b)) + 1) =l= 3 + arctan(pg(b)) + sum(bb$con(b,bb), vm(bb))/sum(bb$con(b,bb), 1);
cost..      3*obj + sum(b, log(1 + pg(b))) =e= sum(b, (20 + 5*ord(b))*pg(b) + 2*sqr(pg(b))) + 1/(1 + exp(-sum(b, vm(b))));
vm.lo(b) = .9; vm.up(b) = 1.1; vm.l(b) = 1; va.fx('b1') = 0; va.lo(b) = -1; va.up(b) = 1; va.fx('b1') = 0; pg.up(b)$typ(b) = 3; pg.fx(b)$(not typ(b)) = 0;
model opf / all /;
solve opf using dnlp minimizing obj;
