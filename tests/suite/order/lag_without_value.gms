* A lag by `na` or `undf` is an error while running, and leads nowhere; by infinity it only leads nowhere.
set i / 1*4 /;  parameter p(i), q(i), r(i);  scalar s / na /;
p(i) = ord(i);
q(i) = p(i+s);
s = inf;
r(i) = 1 + p(i+s);
*= q('1') 0
*= r('1') 1
*! execution 4
