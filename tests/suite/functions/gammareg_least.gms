* What is below e^-88 in `gammareg` is 0; `ncpcm` of a number and 0 is 0.
scalar a, b, c, d;
a = gammareg(51.5, 173.5);  b = gammareg(53.2, 173.5);  c = ncpcm(5, 0, 0.1);  d = ncpcm(0, 9.63, 0.1);
option decimals = 8;  display a, c, d;
*= b 6.476658619606483e-39
*> ----      4 PARAMETER a                    =   0.00000000
*>             PARAMETER c                    =   0.00000000
*>             PARAMETER d                    =   0.00000000
