$title A process with scalar variables, ratios and tolerances
variables f, x2, x3, x6, e7, e8, e9, e10;
positive variables olef, alky, iso, acid, octane, ratio, dil;
scalar lo / .99 /, up; up = 2 - lo;
equations obj, d1, d2, d3, d4, d5, d6, d7;
obj..  f =e= -6.3*alky*octane + 5.04*olef + 0.35*x2 + x3 + 3.36*x6;
d1..   alky*e7 =e= olef*(1.12 + .13167*ratio - .0067*ratio*ratio);
d2..   100*acid =e= 98*x3/(alky*dil/1000 + x3)*1.0;
d3..   octane*e8 =e= .8635 + (1.098*ratio - .038*sqr(ratio))/100 + .325*(acid - .89);
d4..   dil*e9 =e= 35.82 - 22.2*e10;
d5..   x2 + olef =e= ratio*olef;
d6..   alky =e= (olef + iso)/1.22;
d7..   x6 =g= sqrt(olef)*log(1 + iso)/10 - 1/dil;
olef.up = 2; olef.l = 1.7; x2.lo = 0; x2.up = 1.6; x3.lo = 0; x3.up = 1.2; x3.l = .5; alky.lo = .5; alky.up = 5; alky.l = 3; iso.up = 2; x6.lo = 0; x6.up = 5;
acid.lo = .85; acid.up = .93; octane.lo = .9; octane.up = .95; ratio.lo = 3; ratio.up = 12; ratio.l = 8; dil.lo = 1.2; dil.up = 40; dil.l = 8;
e7.lo = lo; e7.up = up; e8.lo = .9*lo; e8.up = up; e9.lo = lo; e9.up = up; e7.l = 1; e8.l = 1; e9.l = 1; e10.lo = 1.45; e10.up = 1.62; e10.l = 1.5;
model alk / all /;
solve alk using nlp minimizing f;
