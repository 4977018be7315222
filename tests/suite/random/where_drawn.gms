* Where random numbers in a condition are drawn: records that are found by indices that come once and without lags, and
* the same label, tell where a value can be other than 0; `not`, comparisons of two things that vary, `eps` and sums do not.
set i / a, b, c, d, e /;  alias(i,k);
parameter q(i) / b 1, c 3, e 2 /, m(i,i) / a.b 1, a.d 2, c.a 3, d.a 1, b.e 4, e.e 1 /, p(i), draws(*);
scalar n, drawn, next, x, zero / 0 /;
$macro count(l) next = uniform(0,1); option seed = 3141; n = uniform(0,1); drawn = 0; while(n <> next and drawn < 50, drawn = drawn + 1; n = uniform(0,1)); draws(l) = drawn;
option seed = 3141; p(i) = 9; x = 0; p(i) = diag(i,'b')$uniform(0,1); count('the same label')
option seed = 3141; p(i) = 9; x = 0; p(i) = (q(i)*diag(i,'b'))$uniform(0,1); count('the same label times records')
option seed = 3141; p(i) = 9; x = 0; p(i) = (q(i) + diag(i,'a'))$uniform(0,1); count('records or a label')
option seed = 3141; p(i) = 9; x = 0; p(i) = diag(i,'b')$uniform(0,1) + q(i); count('beside records')
option seed = 3141; p(i) = 9; x = 0; p(i) = diag(i,'b')$uniform(0,1) + 1; count('beside a number')
option seed = 3141; p(i) = 9; x = 0; p(i) = q(i)$uniform(0,1) + m(i,i); count('beside an index twice')
option seed = 3141; p(i) = 9; x = 0; p(i) = m(i,i)*(q(i)$uniform(0,1)); count('times an index twice')
option seed = 3141; p(i) = 9; x = 0; p(i) = min(q(i)$uniform(0,1), 1); count('min with a number')
option seed = 3141; p(i) = 9; x = 0; p(i) = min(diag(i,'a')$uniform(0,1), q(i)); count('min with records')
option seed = 3141; p(i) = 9; x = 0; p(i) = (q(i)$uniform(0,1)) > 1; count('compared with a number')
option seed = 3141; p(i) = 9; x = 0; p(i) = (q(i)$uniform(0,1)) > q(i); count('compared with records')
option seed = 3141; p(i) = 9; x = 0; p(i) = not (q(i)$uniform(0,1)); count('not')
option seed = 3141; p(i) = 9; x = 0; p(i) = (q(i)$uniform(0,1)) and (1 + eps); count('eps')
option seed = 3141; p(i) = 9; x = 0; p(i) = q(i) and (uniform(0,1)$ord(i)); count('drawn under a condition')
option seed = 3141; p(i) = 9; x = 0; p(i) = q(i) and ord(i)$uniform(0,1); count('a drawn condition')
option seed = 3141; p(i) = 9; x = 0; p(i) = ord(i)$uniform(0,1)$q(i); count('two conditions')
option seed = 3141; p(i) = 9; x = 0; p(i) = ord(i)$uniform(0,1)$q(i+1); count('two conditions, the last with a lag')
option seed = 3141; p(i) = 9; x = 0; p(i) = (ord(i)$uniform(0,1))$q(i+1); count('a condition outside')
option seed = 3141; p(i) = 9; x = 0; p(i) = (zero and q(i))$uniform(0,1); count('zero and records')
option seed = 3141; p(i) = 9; x = 0; p(i) = min(0, q(i))$uniform(0,1); count('min of zero and records')
option seed = 3141; p(i) = 9; x = 0; x = sum(i$(diag(i,'b')$uniform(0,1)), 1); count('of a sum')
option seed = 3141; p(i) = 9; x = 0; x = sum(i$(uniform(0,1) > 0.4 or q(i)), q(i)); count('or, where records are summed')
option seed = 3141; p(i) = 9; x = 0; loop(i$(q(i)$uniform(0,1)), x = x + 1); count('of a loop')
option seed = 3141; p(i) = 9; x = 0; p(i) = sum(k, diag(i,'b')$uniform(0,1)); count('of a sum over a sum')
option seed = 3141; p(i) = 9; x = 0; p(i) = sum(k, m(i,k))$uniform(0,1); count('over a sum of records')
*= draws('the same label') 1
*= draws('the same label times records') 1
*= draws('records or a label') 4
*= draws('beside records') 3
*= draws('beside a number') 5
*= draws('beside an index twice') 5
*= draws('times an index twice') 3
*= draws('min with a number') 5
*= draws('min with records') 4
*= draws('compared with a number') 3
*= draws('compared with records') 5
*= draws('not') 5
*= draws('eps') 5
*= draws('drawn under a condition') 3
*= draws('a drawn condition') 5
*= draws('two conditions') 3
*= draws('two conditions, the last with a lag') 5
*= draws('a condition outside') 3
*= draws('zero and records') 3
*= draws('min of zero and records') 3
*= draws('of a sum') 1
*= draws('or, where records are summed') 3
*= draws('of a loop') 3
*= draws('of a sum over a sum') 5
*= draws('over a sum of records') 5
