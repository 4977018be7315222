* Tiny results.
scalar y; y = gammareg(51.5,173.5); display y; y = ncpcm(5,0,0.1); display y;
*> ----      2 PARAMETER y                    =        0.000
*>
*> ----      2 PARAMETER y                    =        0.000
