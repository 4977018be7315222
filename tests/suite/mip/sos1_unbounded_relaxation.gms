* A program whose relaxation is unbounded has a solution all the same, where ordered sets bound it

set i / a, b, c /, side / plus, minus /;
parameter t(i) / a 1, b -2, c 4 /;
variable z; sos1 variable s(i,side);
equation gap(i), total;
gap(i).. s(i,'plus') - s(i,'minus') =e= t(i);
total.. z =e= sum((i,side), s(i,side));
model m / all /;
solve m maximizing z using mip;
*= m.modelstat 1
*= z.l 7
*= s.l('b','minus') 2
*= s.l('b','plus') 0
