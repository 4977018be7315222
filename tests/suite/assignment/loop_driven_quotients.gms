* What a loop around one assignment passes over where a quotient or `eps` stands in it: a negative divisor or an infinite one hides a record.
set i / a, b /, j / x, y /;  alias (i,i2);  parameter p(j), q(i) / a 3 /, r(i) / b 2 /, w(i,j) / a.x 3, a.y 2 /, g(i,i2) / a.a 5, a.b 4 /, got(*);  scalar s / 2 /;
p(j) = 9;  loop(i, p(j) = q(i)/(-2));                    got('by a negative number') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = w(i,j)/(-2));                  got('by a negative number, two indices') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i)/(-s));                    got('by a negative scalar') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = -(q(i)/2));                    got('a negative quotient') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i)/inf);                     got('by infinity') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = 5$(q(i)/na));                  got('by na') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i)/(-2)/(-2));               got('twice by negative numbers') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i)/(-2)*r(i));               got('a factor behind') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i) + r(i)/(-2));             got('a sum with a quotient') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i)/(-2) + r(i)/2);           got('a sum with a quotient ahead') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i)*eps);                     got('times eps') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = q(i) + eps);                   got('plus eps') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = 5$(eps$q(i)));                 got('eps under a record') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = g(i,i)*eps);                   got('an index twice and eps') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = g(i,i)$eps);                   got('an index twice under eps') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = g(i,i)/inf);                   got('an index twice by infinity') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = g('a',i)/(-2));                got('a label ahead, by a negative number') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = g(i,'a')/(-2));                got('a label behind, by a negative number') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = sum(i2, g(i,i2))/(-2));        got('a sum by a negative number') = p('x') + 100;
p(j) = 9;  loop(i, p(j) = abs(q(i)/(-2)));               got('abs') = p('x') + 100;
*= got('by a negative number') 100
*= got('by a negative number, two indices') 100
*= got('by a negative scalar') 100
*= got('a negative quotient') 98.5
*= got('by infinity') 100
*= got('by na') 105
*= got('twice by negative numbers') 100
*= got('a factor behind') 100
*= got('a sum with a quotient') 99
*= got('a sum with a quotient ahead') 101
*= got('times eps') 100
*= got('plus eps') 100
*= got('eps under a record') 105
*= got('an index twice and eps') 100
*= got('an index twice under eps') 105
*= got('an index twice by infinity') 100
*= got('a label ahead, by a negative number') 98
*= got('a label behind, by a negative number') 100
*= got('a sum by a negative number') 100
*= got('abs') 100
