* bmod only: colours for exams, two with the same pupils apart, pair by pair. That five exams any two of which exclude each other need
* five colours is seen by cliques: 13 nodes, and 94 without them.
option mip = bmip;
set i 'exams' / 1*20 /, c 'colours' / 1*6 /;
alias (i,j);
set p(i,j) 'with the same pupils';
p(i,j) = ord(j) > ord(i) and (ord(j) - ord(i) <= 4);
binary variables x(i,c), used(c);
variable z;
equations count, one(i), apart(i,j,c);
count..             z =e= sum(c, used(c));
one(i)..            sum(c, x(i,c)) =e= 1;
apart(p(i,j),c)..   x(i,c) + x(j,c) =l= used(c);
model exams / all /;
exams.optcr = 0;
solve exams using mip minimizing z;
scalar few 'nodes';
few = exams.nodUsd < 40;
*= exams.modelstat 1
*= z.l 5
*= few 1
