* An error in a constant is told only beside a record.
set i / a, b /; parameter a(i) / a 1 /, p(i); p(i) = a(i)*log2(-1.019); display p;
scalar k / 0 /; p(i) = a(i)/k; display p;
*! execution 2
*! execution 3
*> ----      2 PARAMETER p
*>
*> a UNDF
*>
*> ----      3 PARAMETER p
*>
*> a UNDF,    b UNDF
