* `na` in extrinsic functions.
scalar x / na /, y; y = edist(x,1,1); display y; y = poly(2,x,1,1); display y; y = ncpf(x,1,0); display y; y = betareg(x,1,1); display y;
*! execution 2
*! execution 2
*! execution 2
*! execution 2
*> ----      2 PARAMETER y                    =         UNDF
*>
*> ----      2 PARAMETER y                    =         UNDF
*>
*> ----      2 PARAMETER y                    =         UNDF
*>
*> ----      2 PARAMETER y                    =         UNDF
