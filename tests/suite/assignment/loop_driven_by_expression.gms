* What a loop around one assignment passes over: turns in which the right side is 0 because records are absent; relations,
* `and`, powers, `max` and sums count, other functions do not, nor does what is drawn.
set j / x, y, v /, t / 1*3 /, d(j) / x /;  parameter q(j) / x 4 /, r(j) / x 3, y 2 /, m(j,t) / x.2 2 /, p(t), got(*);
p(t) = 5;  loop(j, p(t) = q(j)*r(j));             got('product') = p('1');
p(t) = 5;  loop(j, p(t) = r(j)$(q(j) > 1));       got('relation') = p('1');
p(t) = 5;  loop(j, p(t) = q(j) + m(j,t));         got('sum') = p('2');
p(t) = 5;  loop(j, p(t) = q(j)**2);               got('power') = p('1');
p(t) = 5;  loop(j, p(t) = max(0, q(j)));          got('max') = p('1');
p(t) = 5;  loop(j, p(t) = 3$sameas(j,'x'));       got('sameas') = p('1');
p(t) = 5;  loop(j, p(t) = 3$(q(j) or d(j)));      got('or') = p('1');
p(t) = 5;  loop(j, p(t) = sum(t.local, m(j,t)));  got('over') = p('1');
p(t) = 5;  loop(j, p(t) = min(q(j), 3));          got('min') = p('1');
p(t) = 5;  loop(j, p(t) = exp(q(j)) - 1);         got('exp') = p('1');
p(t) = 5;  loop(j, p(t) = q(j)*uniform(0,1));     got('random') = p('1');
p(t) = 5;  loop(j, p(t) = 3$(not d(j)));          got('not') = p('1');
*= got('product') 12
*= got('relation') 3
*= got('sum') 6
*= got('power') 16
*= got('max') 4
*= got('sameas') 3
*= got('or') 3
*= got('over') 2
*= got('min') 0
*= got('exp') 0
*= got('random') 0
*= got('not') 3
