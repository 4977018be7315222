* `option p > s` needs a set of a number, an element and what takes its place

set i / a, b, c /, p(i,i);
option p > i;
*! error 4
