$title Hanging chain by the trapezoid rule, scalars in formulas, roots
$if not set nh $set nh 20
set nh / i0*i%nh% /; alias (nh,i);
scalar a / 1 /, b / 3 /, tf / 1 /, len / 4 /, h; h = tf/%nh%;
variables x(i), u(i), energy;
equations xeq(i), lengthd, def;
def..      energy =e= 0.5*h*sum(nh(i+1), x(i)*sqrt(1 + sqr(u(i))) + x(i+1)*sqrt(1 + sqr(u(i+1))));
xeq(i+1).. x(i+1) =e= x(i) + 0.5*h*(u(i) + u(i+1));
lengthd..  0.5*h*sum(nh(i+1), sqrt(1 + sqr(u(i))) + sqrt(1 + sqr(u(i+1)))) =e= len;
x.fx('i0') = a; x.fx('i%nh%') = b;
x.l(i) = a + (b - a)*(ord(i) - 1)/%nh%; u.l(i) = 4*((ord(i) - 1)/%nh% - 0.25);
model chain / all /;
solve chain using nlp minimizing energy;
