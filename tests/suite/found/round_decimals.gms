* Ties of `round` with decimals.
scalar x; x = round(0.35,1); display x; x = round(0.15,1); display x;
x = round(19.095,2); display x; x = round(8.35,1); display x; x = round(0.49999999999999994); display x;
*> ----      2 PARAMETER x                    =        0.400
*>
*> ----      2 PARAMETER x                    =        0.200
*>
*> ----      3 PARAMETER x                    =       19.100
*>
*> ----      3 PARAMETER x                    =        8.400
*>
*> ----      3 PARAMETER x                    =        1.000
