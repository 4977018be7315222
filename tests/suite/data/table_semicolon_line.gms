* The `;` that ends a table may begin a line on which further statements stand.
set i / a, b /;
table t(i,*)
     c  d
a    1  2
b    3  4
; display t; scalar s; s = sum(i, t(i,'c'));
table u(i,*)
$onDelim
dummy,c,d
a,1,2
b,3,
$offDelim
; display u; display s;
*= s 4
*= u('b','c') 3
*= t('b','d') 4
*> ----      7 PARAMETER t
*>
*>             c           d
*>
*> a       1.000       2.000
*> b       3.000       4.000
*>
*> ----     14 PARAMETER u
*>
*>             c           d
*>
*> a       1.000       2.000
*> b       3.000
*>
*> ----     14 PARAMETER s                    =        4.000
