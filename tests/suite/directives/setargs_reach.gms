* The last name of `$setArgs` takes all arguments that are left; its names are local. Those of `$setNames` and `$setComps` are not:
* a local name hides them, `$drop` removes them.
$onEcho > setargs_reach.inc
$setArgs one two
$if "%one%|%two%" == "a|b  x c d" n = n + 1;
$drop two
$if set two n = n + 10;
$offEcho
scalar n / 0 /;
$batInclude setargs_reach.inc a "b  x"   c 'd'
$setLocal a 0
$setNames dir/x.y a b c
$setComps u.v d e f
$if "%a%|%b%|%c%|%d%|%e%|%f%" == "0|x|.y|u|v|" n = n + 100;
$drop b
$drop d
$if not set b $if not set d n = n + 1000;
*= n 1111
