* `holdFixed` sets the level of a fixed variable to its bound.
variable x, y, z; equation e; x.fx = 1.5; x.l = 2.8; y.lo = 1;
e.. z =e= x + y; model m / all /; m.holdfixed = 1;
solve m using lp min z; display x.l, z.l;
*> ----      4 VARIABLE x.L                   =        1.500
*>             VARIABLE z.L                   =        2.500
