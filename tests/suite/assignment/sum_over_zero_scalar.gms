* A sum divides by a scalar for every element, also where what is divided is 0.
set i / a, b /;  parameter p(i) / a 0 /;  scalar none / 0 /, s;
s = sum(i, p(i)/none);
display s;
*! execution 3
*> ----      4 PARAMETER s                    =         UNDF
