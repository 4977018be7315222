* Smooth functions at infinity.
scalar x / inf /, y; y = sqrec(x); display y; y = slexp(-x); display y; y = sllog10(x); display y; y = loggamma(x); display y; y = round(x); display y;
*> ----      2 PARAMETER y                    =  1.0000E-299
*>
*> ----      2 PARAMETER y                    =        0.000
*>
*> ----      2 PARAMETER y                    =      299.000
*>
*> ----      2 PARAMETER y                    =  1.0000E+299
*>
*> ----      2 PARAMETER y                    =  1.0000E+299
