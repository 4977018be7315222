$title Patterns of cutting as a set that grows in a loop
set w 'widths' / w1*w4 /, p 'patterns' / p1*p10 /, pp(p);
parameter width(w) / w1 45, w2 36, w3 31, w4 14 /, dem(w) / w1 97, w2 610, w3 395, w4 211 /, aip(w,p); scalar roll / 100 /;
pp(p) = ord(p) <= card(w);
aip(w,pp(p))$(ord(w) = ord(p)) = floor(roll/width(w));
variable z; positive variable x(p);
equations o, d(w);
o..     z =e= sum(pp, x(pp));
d(w)..  sum(pp, aip(w,pp)*x(pp)) =g= dem(w);
model master / o, d /;
set pi(p); pi(p)$(ord(p) = card(pp) + 1) = yes;
scalar k; parameter used(p);
for(k = 1 to 3,
  solve master using lp minimizing z;
  aip(w,pi) = floor(roll/width(w)/(1 + mod(ord(w) + k, 2)))$(ord(w) <= k);
  used(pi) = sum(w, aip(w,pi)*width(w));
  aip(w,pi)$(used(pi) > roll) = 0;
  pp(pi) = yes; pi(p) = pi(p-1);
);
solve master using lp minimizing z;
display aip, x.l, d.m;
