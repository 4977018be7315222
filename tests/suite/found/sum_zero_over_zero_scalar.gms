* A sum over zeros divided by a zero scalar is an error.
set i / a, b /; parameter p(i) / a 0 /; scalar f / 0 /, s;
s = sum(i, p(i)/f); display s;
*! execution 3
*> ----      3 PARAMETER s                    =         UNDF
