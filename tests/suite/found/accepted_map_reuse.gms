* A map used again by its own indices is refused.
set i / a, b /, j / x, y /, m(i,j) / a.x, b.y /; scalar s;
s = sum((i,j), sum(m(i,j), 1)); display s;
loop(m(i,j), s = sum(m(i,j), 5)); display s;
*! error 4
