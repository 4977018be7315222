* Rows with a side at one end are not like rows with a side at the other: these binaries differ.
integer variables c, e, z;  binary variables x, y;  variable d;
c.up = 3;  e.up = 1;  z.up = 1;
equations x1, x2, y1, y2, gap, total;
x1.. 3*x + c - e =g= 2;
x2.. x + c - e =l= 3;
y1.. y + c - e =g= 0;
y2.. 3*y + c - e =l= 3;
gap.. c - e + z =g= 1;
total.. d =e= 3*c - 2*e + 5*z;
model m / all /;
option optcr = 0;
solve m using mip minimizing d;
*= m.modelstat 1
*= d 3
*= x 1
*= y 0
