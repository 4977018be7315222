* An attribute of a set's element, or a special value, before a number in parentheses are two items; before a set, it is its index.
set i / a, b /;
parameter p(i) / a 1.5, b 2 /;
file f / 'two.txt' /;
put f;
loop(i, put i.ord (p(i)*2) i.tl (p(i)) /; );
put na (p('a')) inf (5):3:0 yes (eps) /;
$onUndf
put undf (p('a')):5:1 /;
putclose;
*|two.txt|         1.00        3.00a                   1.50
*|two.txt|         2.00        4.00b                   2.00
*|two.txt|           NA        1.50        +INF  5         YES        0.00
*|two.txt|         UNDF  1.5
