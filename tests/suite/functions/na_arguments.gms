* Functions of three and more arguments refuse `na`; of one or two they are `na`.
scalar x / na /, y;
y = edist(x,1);       display y;
y = edist(x,1,1);     display y;
y = poly(2,x,1,1);    display y;
y = betareg(x,1,1);   display y;
y = min(x,1,2);       display y;
*! execution 4
*! execution 5
*! execution 6
*> ----      3 PARAMETER y                    =           NA
*>
*> ----      4 PARAMETER y                    =         UNDF
*>
*> ----      5 PARAMETER y                    =         UNDF
*>
*> ----      6 PARAMETER y                    =         UNDF
*>
*> ----      7 PARAMETER y                    =           NA
