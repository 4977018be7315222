$title Processes with recipes: yields by negative and positive coefficients, one equation for all balances
sets c / crude, naphtha, gasoil, gasoline, heating, residue /, cr(c) / crude /, ci(c) / naphtha, gasoil, residue /, cf(c) / gasoline, heating, residue /,
     p / distil, reform, crack, mixg, mixh /, m / still, reformer, cracker /;
table a(c,p)
             distil  reform  crack  mixg  mixh
 crude        -1
 naphtha       .3     -1      .1
 gasoil        .4            -1           -.8
 gasoline              .8     .6    1
 residue       .28            .2          -.2
 heating                                   1 ;
table b(m,p)
             distil reform crack
 still         1
 reformer             1
 cracker                    1 ;
parameters pf(c) / gasoline 60, heating 45, residue 10 /, pm(c) / crude 30 /, k(m) / still 100, reformer 20, cracker 30 /, u(cr) / crude 90 /;
variables z(p) 'process level', x(c) 'sales', imp(c), phi; positive variables z, x, imp;
equations mbf(c), mbi(c), mbr(c), cc(m), obj, req;
mbf(cf)..  sum(p, a(cf,p)*z(p)) =g= x(cf);
mbi(ci)$(not cf(ci))..  sum(p, a(ci,p)*z(p)) =g= 0;
mbr(cr)..  imp(cr) + sum(p$(a(cr,p) < 0), a(cr,p)*z(p)) =g= 0;
cc(m)..    sum(p, b(m,p)*z(p)) =l= k(m);
req..      x('heating') =g= .1*sum(cf, x(cf));
obj..      phi =e= sum(cf, pf(cf)*x(cf)) - sum(cr, pm(cr)*imp(cr)) - sum(p, 0.5*ord(p)*z(p));
imp.up(cr) = u(cr);
model ref / all /;
solve ref using lp maximizing phi;
