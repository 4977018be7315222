* A recurrence by lags goes in place, also beside records that are named by all their labels, in a factor, a condition or the
* condition on the left: those have their values from before. A label among indices makes it read all values from before.
set i / a, b, c, d, e /, s(i) / a /;  alias(i,j);
parameter p(i), q(i,i), around(i), after(i), twice(i), under(i), only(i), row(i,i), column(i,i);
variable x(i);
p(i) = ord(i);  p(i++1) = p('a') + p(i--1);          around(i) = p(i);
p(i) = ord(i);  p(i+1) = p('c') + p(i-1);            after(i) = p(i);
p(i) = ord(i);  p(i+1) = p('c')*p('b') + p(i-1);     twice(i) = p(i);
p(i) = ord(i);  p(i+1) = 1$p('c') + p(i-1);          under(i) = p(i);
p(i) = ord(i);  p(i+1)$(p('c') > 0) = p(i-1);        only(i) = p(i);
q(i,j) = 10*ord(i) + ord(j);  q(i+1,j) = q('b','c') + q(i-1,j);   row(i,j) = q(i,j);
q(i,j) = 10*ord(i) + ord(j);  q(i+1,j) = q('b',j) + q(i-1,j);     column(i,j) = q(i,j);
x.l(i) = ord(i);  x.l(i+1) = x.l('c') + x.l(i-1);
s(i+1) = s('b') or s(i-1);
*= around('a') 8
*= around('b') 6
*= around('c') 2
*= around('d') 7
*= around('e') 3
*= after('a') 1
*= after('b') 3
*= after('c') 4
*= after('d') 6
*= after('e') 7
*= twice('a') 1
*= twice('b') 6
*= twice('c') 7
*= twice('d') 12
*= twice('e') 13
*= under('a') 1
*= under('b') 1
*= under('c') 2
*= under('d') 2
*= under('e') 3
*= only('a') 1
*= only('b') 0
*= only('c') 1
*= only('d') 0
*= only('e') 1
*= row('b','a') 23
*= row('c','a') 34
*= row('d','a') 46
*= row('e','a') 57
*= column('b','a') 21
*= column('c','a') 32
*= column('d','a') 42
*= column('e','a') 52
*= x.l('a') 1
*= x.l('b') 3
*= x.l('c') 4
*= x.l('d') 6
*= x.l('e') 7
*= s('b') 0
*= s('c') 1
*= s('d') 0
*= s('e') 1
