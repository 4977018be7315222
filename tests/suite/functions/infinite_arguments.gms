* To smoothed functions, `round` and `loggamma` infinity is a large number.
scalar x / inf /, y;
y = sqrec(x);     display y;
y = slexp(-x);    display y;
y = sllog10(x);   display y;
y = loggamma(x);  display y;
y = round(-x);    display y;
y = round(x,2);   display y;
*> ----      3 PARAMETER y                    =  1.0000E-299
*>
*> ----      4 PARAMETER y                    =        0.000
*>
*> ----      5 PARAMETER y                    =      299.000
*>
*> ----      6 PARAMETER y                    =  1.0000E+299
*>
*> ----      7 PARAMETER y                    =  -1.000E+299
*>
*> ----      8 PARAMETER y                    =         +INF
