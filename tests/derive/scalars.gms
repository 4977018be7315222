$title Scalars only, the same variable several times, coefficients that cancel, constants on both sides, bounds of every sign
variables x1, x2, x3, x4, obj; positive variable x5; negative variable x6; free variable x7;
scalars a / 3 /, b / -2 /, zero / 0 /;
equations e1, e2, e3, e4, e5, e6;
e1..  obj - 2*x1 =e= 3*x2 - x1 + 4 - (x3 - x3) + zero*x4 + 2*(x5 - (x6 + 1))/4;
e2..  x1 + x2 + 7 =g= 3*(x3 - 2) - (-x1);
e3..  a*x1 + b*(x2 - x3) =l= 12 + x2/2;
e4..  x5 + x6 + x7 =e= a**2 - sqr(b)$(zero = 0);
e5..  -(x4 - 3) =g= -8;
e6..  10 =l= 4*x5 + (3 - a)*x7 + x4 - x6;
x1.lo = -4; x1.up = 9; x2.lo = 1; x3.up = -1; x3.lo = -6; x4.lo = -2; x7.lo = -5; x7.up = 5; x6.lo = -3;
model s / all /;
solve s using lp minimizing obj;
