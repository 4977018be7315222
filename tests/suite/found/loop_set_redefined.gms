* The set of a loop may not change in it.
set i / a, b, c /, d(i); d(i) = yes; loop(d(i), d('c') = no); display d;
*! error 2
