* A label of no set reads nothing in an equation; it gets a place in the order of labels.
set i / a, b /;  parameter cost(*,i) / fuel.a 3 /;  variable z;  equation e;
e.. z =e= sum(i, cost('wages',i)) + cost('fuel','a');
set k / rent, wages /;
model m / all /;  solve m using lp minimizing z;
display z.l, k;
*> ----      6 VARIABLE z.L                   =        3.000
*>
*> ----      6 SET k
*>
*> wages,    rent
