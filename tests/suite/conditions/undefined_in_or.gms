* An undefined value anywhere makes `sor` and `sand` undefined.
set i / a, b /;  scalar z, r;  z = 1/0;
r = sor(i, ord(i) >= z);  display r;
r = sand(i, z > 1 and ord(i) > 0);  display r;
*! execution 2
*> ----      3 PARAMETER r                    =         UNDF
*>
*> ----      4 PARAMETER r                    =         UNDF
