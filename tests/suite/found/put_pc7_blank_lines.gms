* Blank lines under `.pc = 7`.
file f / f.txt /; f.pc = 7; put f; put / 'x' / ; putclose;
*|f.txt|
*|f.txt| x
