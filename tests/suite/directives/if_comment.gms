* What stands behind a true condition is read as at the begin of a line: a comment is one there, too.
scalar x / 1 /;
$set n 3
$if '' == '' * the comment of %n%
$if not set nothing *x = 2;
$if set n x = x + 10;
*= x 11
