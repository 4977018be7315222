* A set statement with the name of an alias gives the set its text and its elements.
set j, u / 1*5 /, k(u);
alias(j,i), (k,l);
set i 'jobs' / a, b, c /;
set l(u) / 1, 3 /;
parameter p(j) / b 2 /;
display j, i;
*= card(j) 3
*= p('b') 2
*= k('3') yes
*= card(k) 2
*> ----      7 SET j  jobs
*>
*> a,    b,    c
*>
*> ----      7 SET i  Aliased with j
*> a,    b,    c
