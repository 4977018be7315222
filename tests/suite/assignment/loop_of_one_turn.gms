* No turn of a loop is passed over for an index whose set has one element, when the loop is reached.
set l / a, b, c /, j / x, y /, one(l) / b /, now(l);
parameter q(l) / c 1 /, none(l), m(l,l) / c.a 1 /, p(j), got(*);
none(l) = 0;  now(l) = no;  now('b') = yes;
p(j) = 9;  loop(one, p(j) = q(one));             got('one') = p('x');
p(j) = 9;  loop(now, p(j) = q(now));             got('now') = p('x');
p(j) = 9;  loop((l,one), p(j) = q(one));         got('behind') = p('x');
p(j) = 9;  loop((one,l), p(j) = none(l));        got('of the other') = p('x');
p(j) = 9;  loop((l,one), p(j) = m(one,l));       got('of both') = p('x');
p(j) = 9;  loop(one, loop(l, p(j) = none(one))); got('in a loop') = p('x');
p(j) = 9;  loop(one, p(j) = 3$sameas(one,'x'));  got('labels') = p('x');
p(j) = 9;  loop(one(l), p(j) = q(l));            got('as a map') = p('x');
now('a') = yes;
p(j) = 9;  loop(now, p(j) = q(now));             got('two now') = p('x');
*= got('one') 0
*= got('now') 0
*= got('behind') 0
*= got('of the other') 9
*= got('of both') 9
*= got('in a loop') 0
*= got('labels') 0
*= got('as a map') 9
*= got('two now') 9
