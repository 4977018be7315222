* A line that is only the mark of an inline comment opens one over lines; the mark ends it in the first column as well.
$onInline
scalar k / 1 /;
/*
k = 6;
* k = 7;
*/
k = k + 1;
/*
* inner */ k = k + 10;
set t / a*d /;
parameter p(t)
/
/*
a 1
b 3
*/
c 4
d 5
/;
*= k 12
*= p('a') 0
*= p('c') 4
*= card(p) 2
