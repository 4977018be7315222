* bmod only: seven boxes in a strip of width 10, left of each other or below, by large numbers. What a node's contradiction teaches
* holds elsewhere: 3 060 nodes, and 12 279 with `--option without=clause_learning`.
option mip = bmip;
set i 'boxes' / 1*7 /;
alias (i,j);
set p(i,j) 'pairs';
p(i,j) = ord(i) > ord(j);
parameter w(i) 'width' / 1 5, 2 3, 3 6, 4 2, 5 4, 6 5, 7 3 /
          h(i) 'height' / 1 2, 2 4, 3 1, 4 5, 5 3, 6 2, 7 3 /;
scalar most 'height if one stands on the other';
most = sum(i, h(i));
positive variables x(i), y(i);
binary variables left(i,j), below(i,j);
variable top;
equations above(i), side(i,j), under(i,j), way(i,j);
above(i).. top =g= y(i) + h(i);
side(i,j)$(not sameas(i,j)).. x(i) + w(i) =l= x(j) + 10*(1 - left(i,j));
under(i,j)$(not sameas(i,j)).. y(i) + h(i) =l= y(j) + most*(1 - below(i,j));
way(p(i,j)).. left(i,j) + left(j,i) + below(i,j) + below(j,i) =g= 1;
x.up(i) = 10 - w(i);
top.up = most;
model strip / all /;
strip.optcr = 0;
solve strip using mip minimizing top;
scalar few 'nodes';
few = strip.nodUsd < 6000;
*= strip.modelstat 1
*= top.l 8
*= few 1
