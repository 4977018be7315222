* bmod only: a line with `+` directly below column labels. GAMS drops the rest of such a table without a word.
set i / a, b /, j / x, y /;
table p(i,j)
       x
+      y
a      2
b      3 ;
*! error 5
