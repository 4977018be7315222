* `option p > s` with fewer numbers than orders: those there are, and an error

set i / a, b, c /, n / n1*n4 /, p(n,i,i);
option p > i;
*! execution 4
