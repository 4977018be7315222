* A loop around one assignment passes over turns without data by the form of the right side: a quotient must have a number
* or a scalar below, a sum no number beside, a power and a comparison a number or a scalar behind; an index that
* comes twice is looked for once.
set i / a, b /, j / x, y /;
parameter q(i,j), w(i), p(j), got(*);
scalar s / 2 /;
q('a','x') = 3;  q('a','x') = 0;  w(i) = 1;
p(j) = 9;  loop(i, p(j) = q(i,j)/2);              got('by a number') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)*w(i)/s);         got('by a scalar') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)/w(i));           got('by a parameter') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)/(w(i)+1)/2);     got('by a sum') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)/card(i));        got('by card') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)/w(i)*q(i,j));    got('factor behind') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)*(1/w(i)));       got('in parentheses') = p('x');
p(j) = 9;  loop(i, p(j) = w(i)$(q(i,j)/w(i)));    got('in a condition') = p('x');
p(j) = 9;  loop(i, p(j) = 1 - 1 + q(i,j));        got('numbers beside') = p('x');
p(j) = 9;  loop(i, p(j) = min(q(i,j),0));         got('min') = p('x');
p(j) = 9;  loop(i, p(j) = max(q(i,j),-1));        got('max') = p('x');
p(j) = 9;  loop(i, p(j) = round(q(i,j),2));       got('round') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)**s);             got('power') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)**w(i));          got('power by a parameter') = p('x');
p(j) = 9;  loop(i, p(j) = w(i)$(q(i,j) > s));     got('more than a scalar') = p('x');
p(j) = 9;  loop(i, p(j) = w(i)$(q(i,j) > -s));    got('more than a term') = p('x');
p(j) = 9;  loop(i, p(j) = w(i)$(q(i,j) = 3));     got('equal') = p('x');
p(j) = 9;  loop(i, p(j) = q(i,j)*eps);            got('eps') = p('x');
parameter g(i,i), h(j,i);  g('a','b') = 4;  g('b','a') = 3;  h('x','b') = 0;  h('y','a') = 6;
p(j) = 9;  loop(i, p(j) = g(i,i));                got('an index twice') = p('x');
p(j) = 9;  loop(i, p(j) = g(i,'a'));              got('a label behind') = p('x');
p(j) = 9;  loop(i, p(j) = h('x',i));              got('a label ahead') = p('x');
s = -2;
p(j) = 9;  loop(i, p(j) = w(i)$(q(i,j) > s));     got('more than a negative scalar') = p('x');
*= got('by a number') 9
*= got('by a scalar') 9
*= got('by a parameter') 0
*= got('by a sum') 0
*= got('by card') 0
*= got('factor behind') 9
*= got('in parentheses') 9
*= got('in a condition') 0
*= got('numbers beside') 0
*= got('min') 9
*= got('max') 0
*= got('round') 0
*= got('power') 9
*= got('power by a parameter') 0
*= got('more than a scalar') 9
*= got('more than a term') 1
*= got('equal') 0
*= got('an index twice') 0
*= got('a label behind') 3
*= got('a label ahead') 9
*= got('more than a negative scalar') 1
