* A variable or an equation without attribute stands for its name, as in what Pyomo writes: `put x1 ' ' x1.l`.
set i / a, 'b c' /;
variable x(i), z;  equation e(i), o;
e(i).. x(i) =g= ord(i);  o.. z =e= sum(i, x(i));
model m / all /;
solve m using lp minimizing z;
file f / 'names.txt' /;
put f;
put z ' ' z.l:0:0 /;
loop(i, put x(i) ' ' x.l(i):0:0 ' ' e(i) '|' /; );
put x('a'):10 '|' z:>4 '|' z (3):0:0 /;
f.tw = 8;
put z x('a') '|' /;
loop(i, put x(i+1) /; );
putclose;
*|names.txt| z 3
*|names.txt| x('a') 1 e('a')|
*|names.txt| x('b c') 2 e('b c')|
*|names.txt| x('a')    |   z|z3
*|names.txt| z       x('a')  |
*|names.txt| x('b c')
*|names.txt| x("")
