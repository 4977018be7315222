* Under `s(i)` the set s does not run, but the text of its element is there: `.tlen`, `.tval`.
set i / a, b, c /;  set s(i) / a '12', c '7.5' /;
parameter p(i), q(i);
loop(s(i), p(i) = s.tlen;  q(i) = s.tval; );
*= p('a') 2
*= q('c') 7.5
