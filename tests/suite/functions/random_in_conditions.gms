* Random numbers in conditions are drawn where the value, or what is stored and changed, can be other than 0.
set i / a1*a4 /, j / b1*b5 /;
parameter q(i,j), r(i,j), v(i), draws(*);
scalar n, k, next;
$macro begin execSeed = 129; q(i,j) = 1; q('a1','b2') = 0; q('a2','b2') = 0; r(i,j) = 0; r('a1','b1') = 2; r('a3','b2') = 3; v(i) = 0; v('a2') = 5;
$macro count(l) next = uniform(0,1); execSeed = 129; n = uniform(0,1); k = 0; while(n <> next and k < 50, k = k + 1; n = uniform(0,1)); draws(l) = k;
begin q(i,j)$(uniform(0,1) < 0.4) = 0;                       count('cleared')
begin q(i,j)$(uniform(0,1) < 0.4) = r(i,j);                  count('stored or read')
begin q(i,j)$(uniform(0,1) < 0.4) = v(i);                    count('read by one index')
begin q('a1',j)$(uniform(0,1) < 0.4) = 0;                    count('in a row')
begin v(i)$(uniform(0,1) < 0.4) = sum(j, r(i,j));            count('sum')
begin q(i,j) = r(i,j)$(uniform(0,1) < 0.4);                  count('value')
begin q(i,j) = v(i)$(uniform(0,1) < 0.4);                    count('value by one index')
begin q(i,j) = r(i,j)$(uniform(0,1) < 0.4) + q(i,j);         count('one of two')
begin q(i,j) = (r(i,j) + 1)$(uniform(0,1) < 0.4);            count('never 0')
begin q(i,j) = r(i,j)*(uniform(0,1) < 0.4);                  count('factor')
begin q(i,j) = 1$(r(i,j) and uniform(0,1) < 0.4);            count('and')
begin v(i) = sum(j, r(i,j)$(uniform(0,1) < 0.4));            count('in a sum')
begin v(i) = sum(j$(uniform(0,1) < 0.4), r(i,j));            count('over a sum')
begin v(i) = smax(j, r(i,j)$(uniform(0,1) < 0.4));           count('in smax')
begin n = sum((i,j), (r(i,j) + q(i,j))$(uniform(0,1) < 0.4)); count('sum of two')
begin q(i,j)$(uniform(0,1) < 0.4) = uniform(0,1);            count('value too')
*= draws('cleared') 18
*= draws('stored or read') 18
*= draws('read by one index') 20
*= draws('in a row') 4
*= draws('sum') 3
*= draws('value') 2
*= draws('value by one index') 5
*= draws('one of two') 18
*= draws('never 0') 20
*= draws('factor') 20
*= draws('and') 20
*= draws('in a sum') 2
*= draws('over a sum') 2
*= draws('in smax') 20
*= draws('sum of two') 18
*= draws('value too') 27
