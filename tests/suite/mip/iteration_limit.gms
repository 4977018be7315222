* In a `mip` the limit of iterations holds for each linear program of the search, not for all together.
set i / 1*4 /, k / 1*16 /; alias (i,j);
binary variable x(i,j,k); variable z;
equation o, each(k), cell(i,j), row(i), column(j);
o.. z =e= sum((i,j,k)$(ord(i) = 1), ord(j)*ord(k)*x(i,j,k));
each(k).. sum((i,j), x(i,j,k)) =e= 1;
cell(i,j).. sum(k, x(i,j,k)) =e= 1;
row(i).. sum((j,k), ord(k)*x(i,j,k)) =e= 34;
column(j).. sum((i,k), ord(k)*x(i,j,k)) =e= 34;
model m / all /; option optCR = 0, iterLim = 300;
solve m using mip maximizing z;
*= m.modelstat 1
*= z.l 114
