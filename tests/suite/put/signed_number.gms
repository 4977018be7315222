* A number with a sign needs parentheses.
file f / f.txt /;  put f (-1):6:1 /;
put -1;
*! error 3
