* Tiny results, eight decimals.
scalar y; y = gammareg(51.5,173.5); option decimals=8; display y; y = ncpcm(0,9.63,0.1); display y;
*> ----      2 PARAMETER y                    =   0.00000000
*>
*> ----      2 PARAMETER y                    =   0.00000000
