* An absent record times a negative power of 0 is 0.
set i / a, b /; parameter a(i) / a 1 /, b(i) / a 4 /, p(i); scalar s;
p(i) = a(i)*b(i)**(-0.5); s = sum(i, a(i)*(1 + b(i)**(-1)));
display p, s;
*> ----      4 PARAMETER p
*>
*> a 0.500
*>
*> ----      4 PARAMETER s                    =        1.250
