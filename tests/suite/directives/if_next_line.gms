* A `$if` with nothing behind its condition speaks of the next line, whatever that is.
$eolCom //
scalar k / 0 /;
$if set nope
k = k + 1;
$if not set nope // a comment is nothing
k = k + 10;
$if set nope
* this comment
k = k + 100;
$if set nope
$if not set nope
k = k + 1000;
$if not set nope
$if set nope
k = k + 10000;
$if not set nope $if set nope
k = k + 100000;
$if set nope $if set nope
k = k + 1000000;
$ifE 1=2
$set k no
$if set k k = 0;
*= k 1001110
