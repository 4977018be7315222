$title Indices in other orders, the same index twice, projections, dollars inside products, parameters over the universe
set i / 1*4 /, ij(i,i), big(i), l / 'a b', c-d /; alias (i,j,h), (*,v);
ij(i,j) = mod(ord(i) + 2*ord(j),3) = 1; big(i)$(sum(ij(i,j), 1) > 1) = yes;
parameter p(*,*), q(i,j), tab(i,*); p('1','cost') = 3; p('3','cost') = 4; p('a b','cost') = 2; q(i,j) = ord(i)/ord(j); tab(i,'low') = -ord(i); tab(i,'high')$big(i) = 2*ord(i);
variables x(i,j), u(l,i), z, dg(i); positive variable u;
equations sym(i,j), tri(i,j,h), diag(i), proj(j), univ(l), one, o;
sym(i,j)$(ord(i) < ord(j))..   x(i,j) + x(j,i) =g= (q(i,j)$ij(i,j))*2$ij(j,i) - 1;
tri(i,j,h)$(ij(i,j) and ij(j,h) and not sameas(i,h)).. x(i,h) =l= x(i,j) + x(j,h) + 6;
diag(i)..   dg(i) =e= x(i,i) - (0.5*x('2',i) - x(i,'3'))$big(i);
proj(j)$(sum(i$ij(i,j), q(i,j)) > 0.5)..  sum(i$ij(i,j), q(i,j)*x(i,j)$(not big(i))) + sum(big(i), x(j,i)) =g= -4;
univ(l)..   sum(i, (p(i,'cost') + p(l,'cost'))*u(l,i)) - sum(ij(i,j)$sameas(l,'a b'), x(ij)) =g= 1.5;
one..       sum((i,j)$(q(i,j) > 1), q(i,j)*q(j,i)*x(j,i)) + sum(i, dg(i)) =l= 9;
o..         z =e= sum((l,i), (1 + p(i,'cost'))*u(l,i)) + sum((i,j), (1$ij(i,j) + .5)*x(i,j)) + sum(i, dg(i)) + sum(ij(i,i), x(i,i));
x.lo(i,j) = -2; x.up(ij) = 3; dg.lo(i) = tab(i,'low'); dg.up(i)$tab(i,'high') = tab(i,'high'); x.lo('1',j)$(ord(j) > 2) = 1;
model m / all /;
solve m using lp minimizing z;
