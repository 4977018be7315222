* A jump leaves the blocks as they are: the `$else` of one that was entered is not.
scalar n / 0 /, wrong / 0 /;
$eval k 0
$ifThen a == a
$label top
$eval k %k%+1
n = n + 1;
$ifE %k%<3 $goto top
$else
wrong = 1;
$endIf
$ifThen.x a == b
wrong = 1;
$else.x
$goto over
wrong = 1;
$label over
n = n + 10;
$endIf.x
*= n 13
*= wrong 0
