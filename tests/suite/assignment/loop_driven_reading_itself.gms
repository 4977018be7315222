* A loop around one assignment that reads what it writes to passes over turns only where no such reading is at the record
* itself or at labels alone, and all is under a `$` whose other side is absent in the turn; for a set the latter does not count.
set i / a*c /, k / 1*4 /, kk(k) / 1, 3 /, u(i);  alias (i,j), (k,kx);
singleton set one(i) / b /;
parameter w(i,j), g(k);
set v(i,j);
parameter q(k) / 1 5, 3 7 /, r(i) / a 1, b 1 /, p(i), got(*);
p(i) = 9;  loop(k, p(i) = q(k)$p(i++1));               got('lag') = p('a');
p(i) = 9;  loop(k, p(i) = p(i++1)$q(k));               got('value') = p('a');
p(i) = 9;  loop(k, p(i) = 2*(q(k)$(p(i++1) > 1)));     got('within') = p('a');
p(i) = 9;  loop(k, p(i) = q(k)$sum(j, p(j)));          got('sum') = p('a');
p(i) = 9;  loop(k, p(i) = sum(j$p(j), q(k)));          got('in sum') = p('a');
p(i) = 9;  loop(k, p(i) = (p(i++1)*q(k))$q(k));        got('product under $') = p('a');
p(i) = 9;  loop(k, p(i) = q(k)$p(i));                  got('own') = p('a');
p(i) = 9;  loop(k, p(i) = q(k)$p('a'));                got('label') = p('a');
p(i) = 9;  loop(k, p(i) = q(k)*p(i++1));               got('product') = p('a');
p(i) = 9;  loop(k, p(i) = q(k)*r(i)$p(i++1));          got('$ of another') = p('a');
p(i) = 9;  loop(k, p(i) = sum(j, q(k)*p(j)));          got('sum of products') = p('a');
p(i) = 9;  loop(k, p(i)$p(i++1) = q(k));               got('left') = p('a');
p(i) = 9;  loop(k, p(i) = sum(kk(k), p(i++1)));        got('member') = p('a');
u(i) = ord(i) < 3;  loop(k, u(i) = q(k)*u(i++1));      got('set') = card(u);
u(i) = ord(i) < 3;  loop(k, u(i) = q(k) and u(i));     got('set, own') = card(u);
w(i,j) = 9;  loop(k, w(i,j) = q(k)$w(i++1,j));         got('lag, two indices') = w('a','b');
w(i,j) = 9;  loop(k, w(i,j) = q(k)$w('a',j));          got('label and own') = w('a','b');
w(i,j) = 9;  loop(k, w(i,j) = q(k)$w(j,i));            got('transposed') = w('a','b');
w(i,j) = 9;  loop(k, w(i,j) = q(k)$w('a','b'));        got('two labels') = w('a','b');
w(i,j) = 9;  loop(k, w(i,j) = q(k)$w(i,j));            got('own, two indices') = w('a','b');
p(i) = 9;  loop(k, p(i) = (2*p(one))$q(k));            got('singleton') = p('a');
p(i) = 9;  loop(k, p(i) = q(k)$(p(one) and p(i)));     got('singleton and own') = p('a');
g(k) = 9;  loop(k, g(kx) = q(k)$g(k));                 got('index of the loop') = g('2');
v(i,j) = ord(i) = ord(j);  loop(k, v(i,j) = q(k)*v('a',j));  got('set, label and own') = card(v);
*= got('lag, two indices') 7
*= got('label and own') 7
*= got('transposed') 7
*= got('two labels') 0
*= got('own, two indices') 0
*= got('singleton') 36
*= got('singleton and own') 0
*= got('index of the loop') 7
*= got('set, label and own') 3
*= got('lag') 7
*= got('value') 9
*= got('within') 14
*= got('sum') 7
*= got('in sum') 21
*= got('product under $') 315
*= got('own') 0
*= got('label') 0
*= got('product') 0
*= got('$ of another') 0
*= got('sum of products') 0
*= got('left') 0
*= got('member') 9
*= got('set') 2
*= got('set, own') 0
