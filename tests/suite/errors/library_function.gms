* bmod only: a function that the library does not have, and the wrong number of arguments
$funcLibIn stolib stodclib
function f /stolib.dnormal/;
scalar x;
x = f(1);
function g /stolib.dcurious/;
*! error 5
*! error 6
