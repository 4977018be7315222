* A set that a loop runs over may not be changed in it, nor a mapping be run over twice.
set i / a, b, c /, j / x, y /, d(i), m(i,j) / a.x, b.y /;  scalar n;
d(i) = yes;
loop(d(i), d('c') = no);
loop(i$d(i), d('c') = no);
loop(d, option clear = d);
n = sum((i,j), sum(m(i,j), 1));
n = sum(m(i,j), sum(m(i,j), 1));
*! error 4
*! error 6
*! error 8
