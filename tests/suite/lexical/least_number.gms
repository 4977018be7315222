* A number below -1e300 is -1e300; a large one without a sign is undefined.
scalar a / -1e300 /, b / -5e305 /, c / 1e300 /, below;  below = a < 0;  display a, b, c, below;
parameter p(*) / x -1e299, y -1e300 /;  display p;
*> ----      2 PARAMETER a                    =  -1.000E+300
*>             PARAMETER b                    =  -1.000E+300
*>             PARAMETER c                    =         UNDF
*>             PARAMETER below                =        1.000
*>
*> ----      3 PARAMETER p
*>
*> x -1.000E+299,    y -1.000E+300
