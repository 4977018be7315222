* Between marks, scientific numbers keep a place for the sign, and special values the width of numbers; under `.pc` 8 widths say nothing.
file f / 'separated.txt' /;
scalar a / 0.01 /, b / -3 /, c / 123456.789 /;
put f;
f.nr = 2;  f.pc = 5;
put a b a:1 a:13:4 c:0:0 /;
f.pc = 8;
put a b:<1 c:5 'text':2 inf:2 /;
f.nr = 1;
put a:1 b:<1 c:5:2 c:3 c:12:1 na:1 /;
f.pc = 5;  f.nw = 2;
put inf na inf:3 inf:0 /;
putclose;
*|separated.txt|  1.00E-02,-3.00E+00,*, 1.0000E-02, 1.E+05
*|separated.txt|  1.00E-02 -3.00E+00  1.23E+05 text +INF
*|separated.txt| 0.01 -3.00 123456.79 123456.79 123456.8 NA
*|separated.txt| "**","NA","***","+INF"
