* Two of a set of which one may be nonzero must not be zero; `bmod why` says which.
set i / 1*3 /;
sos1 variable s(i);
free variable z;
equations e, few;
e..    z =e= sum(i, ord(i)*s(i));
few..  sum(i, s(i)) =l= 5;
s.lo('1') = 1;
s.lo('2') = 1;
s.up(i) = 4;
model m / all /;
solve m using mip minimizing z;
*= m.modelstat 10
*? why s('1')
*? why s('2')
