* `sor` and `sand` of an undefined value.
set i / a, b /; scalar z, r; z = 1/0;
r = sor(i, 1 and 7 >= z); display r; r = ifthen(sor(i, 1 and 7 >= z), 1, 1); display r;
r = sand(i, 7 >= z); display r; r = 1$(sor(i, 7 >= z)); display r;
*! execution 2
*> ----      3 PARAMETER r                    =         UNDF
*>
*> ----      3 PARAMETER r                    =         UNDF
*>
*> ----      4 PARAMETER r                    =         UNDF
*>
*> ----      4 PARAMETER r                    =        1.000
