* Arguments of random functions outside of their domain.
scalar x; x = uniform(0,-1); display x; x = normal(0,-1); display x; x = uniformint(3,2); display x;
*! execution 2
*! execution 2
*! execution 2
*> ----      2 PARAMETER x                    =         UNDF
*>
*> ----      2 PARAMETER x                    =         UNDF
*>
*> ----      2 PARAMETER x                    =         UNDF
