* `option p > s`: all orders of the elements of a set

set i / a, b, c /, n / n1*n6 /, p(n,i,i);
option p > i;
*= card(p) 18
*= p('n1','a','a') yes
*= p('n2','b','c') yes
*= p('n3','a','b') yes
*= p('n4','a','b') yes
*= p('n4','c','a') yes
*= p('n6','a','c') yes
*= p('n6','c','a') yes

* What was there before is gone.
p(n,i,i) = no;
p('n1','a','c') = yes;
option p > i;
*= p('n1','a','c') no
