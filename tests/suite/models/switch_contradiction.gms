* bmod only: a switch of 1e7 makes no contradiction small.

*= m.modelstat 4
positive variable x,b; variable z;
equations o, r1, r2, r3;
o.. z =e= x; r1.. x - 1e7*b =l= 2; r2.. x =g= 7; r3.. b =l= 0;
model m /all/; solve m using lp minimizing z;
