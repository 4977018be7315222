* How many digits the labels between have is not clear.
set i / x01*x12, y8*y11 /;
set j / x01*x9 /;
set k / x1*x010 /;
*! error 3
*! error 4
