* `.pos` and its like are of sets with one index.
set i / a, b /, ij(i,i) / a.b /;  parameter p(i,i);
p(ij) = ij.pos;
*! error 3
