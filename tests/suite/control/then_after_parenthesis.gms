* Under `$onEnd` a condition may stand in parentheses, or begin with one.
$onEnd
set i / a, b /, j / c, d, e /;
scalar n / 1 /, most / 3 /, c, m / 0 /, k;
if (n > 0) then c = 1; else c = 2; endif;
*= c 7
if (n + 1)*2 > most and (n) < 2 then
   c = c + 1;
   if (abs(n)) = 1 then c = c + 5; endif;
elseif (n) = 1 then
   c = 100;
endif;
while (m)*2 < 9 do m = m + 1; endwhile;
*= m 5
loop (i,j)$(ord(i) <> ord(j)) do n = n + 1; endloop;
*= n 5
