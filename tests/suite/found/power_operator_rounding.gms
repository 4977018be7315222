* bmod only (GAMS: 0, 48 and 7 without the option): powers are rounded correctly, and as in GAMS by an option.
set i / 1*8 /; scalar n; n = sum(i$(ord(i)**2 = 16), 1); display n;
n = floor(7**2); display n; n = mod(7**2,7); display n;
option gams_power = on;
n = sum(i$(ord(i)**2 = 16), 1); display n;
n = floor(7**2); display n; n = mod(7**2,7); display n;
*> ----      2 PARAMETER n                    =        1.000
*>
*> ----      3 PARAMETER n                    =       49.000
*>
*> ----      3 PARAMETER n                    =        0.000
*>
*> ----      5 PARAMETER n                    =        0.000
*>
*> ----      6 PARAMETER n                    =       48.000
*>
*> ----      6 PARAMETER n                    =        7.000
