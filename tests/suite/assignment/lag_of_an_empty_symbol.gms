* A lag on the left and on the right: element by element where the symbol has records, from what was before where it has none.
set k / t1*t6 /, s(k);
parameter p(k), q(k), w(k);
p(k) = 0;
p(k+1) = p(k-1) - 1;
*= p('t4') -1
*= p('t6') -1
q('t1') = eps;
q(k+1) = q(k-1) - 1;
*= q('t4') -2
*= q('t6') -3
w(k) = 10*ord(k);
w(k--1) = w(k+1) - 1;
*= w('t6') 19
*= w('t5') -1
s(k) = no;
s(k+1) = not s(k-1);
*= card(s) 5
variable x(k), y(k);
x.l(k) = 0;
x.l(k+1) = x.l(k-1) - 1;
*= x.l('t6') -1
y.up(k) = 5;
y.l(k+1) = y.l(k-1) - 1;
*= y.l('t6') -3
