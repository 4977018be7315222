* A jump out of a block leaves it open (GAMS: 675).
$ifThen a == a
*! error 2
$goto out
$endIf
$label out
scalar n / 1 /;
