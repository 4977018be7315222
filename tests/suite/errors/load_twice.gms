* A second load of the same symbol, or one of a symbol that has data or is assigned, needs `$loadM`, `$loadR` or `$onMulti`.
set i / a, b /, k, m / c /, n(i);
n('a') = yes;
$gdxOut load_twice.gdx
$unload i
$gdxOut
$gdxIn load_twice.gdx
$load k=i
$load k=i
$load m=i
$load n=i
$loadM m=i
$loadR k=i
*! error 9
*! error 10
*! error 11
