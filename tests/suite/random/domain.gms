* Intervals the wrong way round, negative deviations and infinite ends are errors.
scalar x;
x = uniform(1,-1);      display x;
x = normal(2,-1);       display x;
x = uniformInt(4,3);    display x;
x = uniform(0,inf);     display x;
x = uniformInt(0.5,3);  display x;
*! execution 3
*! execution 4
*! execution 5
*! execution 6
*! execution 7
*> ----      3 PARAMETER x                    =         UNDF
*>
*> ----      4 PARAMETER x                    =         UNDF
*>
*> ----      5 PARAMETER x                    =         UNDF
*>
*> ----      6 PARAMETER x                    =         UNDF
*>
*> ----      7 PARAMETER x                    =         UNDF
