* Headings of two labels stand in one line until they do not fit; from there on in two.
parameter p(*,*,*,*) / A.r.x.y 1, B.r.longlabel1.longlabel2 2, C.r.x.y 3 /;
option p:3:1:2;
display p;
*> ----      4 PARAMETER p
*>
*> INDEX 1 = A
*>
*>           x.y
*>
*> r       1.000
*>
*> INDEX 1 = B
*>
*>    longlabel1
*>    longlabel2
*>
*> r       2.000
*>
*> INDEX 1 = C
*>
*>             x
*>             y
*>
*> r       3.000
