* Costs and yields of very different sizes: near rounding errors the pivots of the simplex method may go round in a circle,
* and must come to an end.

set m machines / old, hand, line, robot /, s shifts / night, day, late /,
    runs(m,s) / old.(night,day), hand.(day,late), line.(night,day,late), robot.(night,late) /;
parameter hours(m) / old 34000, hand 12000, line 24000, robot 11000 /,
          need(s)  / night 37200, day 15000, late 5600 /,
          cost(m)  / old 32, hand 80, line 63, robot 88 /,
          noise(m) / old 1.36, hand 0.72, line 0.45 /;
set kept(m) / old, robot /;
variables money, loud, steady, worth;  positive variables x(m,s), quieter, steadier;
equations spent, heard, known, most(m), least(s), limit, floor_, both;
spent..    sum(runs(m,s), cost(m)*x(runs))/1000 =e= money;
heard..    sum(runs(m,s), noise(m)*x(runs)) =e= loud;
known..    sum(runs(kept,s), x(runs)) =e= steady;
most(m)..  sum(runs(m,s), x(runs)) =l= hours(m);
least(s).. sum(runs(m,s), x(runs)) =g= need(s);
limit..    loud + quieter =e= 53420;
floor_..   steady - steadier =e= 26000;
both..     worth =e= -money + 1e-3*(quieter/19330 + 0.1*steadier/12500);
model plan / all /;
solve plan maximizing worth using lp;
*= plan.modelstat 1
*= worth.l -2731.458761
