* Capital and income without levels: powers have no slopes at 0, and next to 0 such steep ones that linear programs see nothing feasible
* nearby. The optimum is that from levels of 1.
Set t / 1*20 /;
Positive variables K(t), S(t), Y(t);
Variables U, D(t);
S.up(t) = 1;  S.l(t) = .25;  Y.lo(t) = 1e-5;  K.fx('1') = .3;
Equations income(t), capital(t), damage(t), utility;
income(t)..     Y(t) =e= .8 * K(t)**.3 - .0003 * sqr(D(t));
capital(t+1)..  K(t+1) =e= 5 * Y(t) * S(t) + .6 * K(t);
damage(t)..     D(t) =e= D(t-1) + 5 * Y(t) * (1 - .05 * ord(t));
utility..       U =e= sum(t, .93**ord(t) * (1 - (Y(t) * (1 - S(t)))**(-.45)));
S.lo(t)$(ord(t) > 10) = .2;
Model growth / all /;
solve growth maximizing U using nlp;
*= growth.modelStat 2
*= U.l -2.85957976
