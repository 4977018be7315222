$title A matrix game and its dual by hand in one text; the value is free; negative variables; transposed use of a parameter
set r / r1*r4 /, c / c1*c5 /;
parameter a(r,c); a(r,c) = mod(3*ord(r)*ord(c) + 2*ord(r), 11) - 5;
variables v, w; positive variable x(r); negative variable y(c);
equations row(c), ones, col(r), mones;
row(c)..  sum(r, a(r,c)*x(r)) =g= v;
ones..    sum(r, x(r)) =e= 1;
col(r)..  w =g= -sum(c, a(r,c)*y(c));
mones..   1 + sum(c, y(c)) =e= 0;
model p / row, ones /, d / col, mones /;
solve p using lp maximizing v;
solve d using lp minimizing w;
abort$(abs(v.l - w.l) > 1e-6) 'no saddle';
