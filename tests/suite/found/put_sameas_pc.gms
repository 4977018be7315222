* `put` of a logical value, and numbers under `.pc = 5`.
set i / a, b /; file f / f.txt /; put f; put sameas('a','b') /;
f.pc = 5; f.nr = 2; put 0 1.5 /; putclose;
*|f.txt|           NO
*|f.txt|  0.00E+00, 1.50E+00
