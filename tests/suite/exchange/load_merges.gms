* Under `$onMulti` a load adds to what is there, under `$onMultiR` it takes its place.
set i / a, b /, k / c /, m / c /;
$gdxOut load_merges.gdx
$unload i
$gdxOut
$gdxIn load_merges.gdx
$onMulti
$load k=i
$onMultiR
$load m=i
*= card(k) 3
*= card(m) 2
