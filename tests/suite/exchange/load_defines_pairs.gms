* `$load` of a set over `i<` and `j<` brings the elements of these first, so that none of its own is left out.
set a / a1, a2, a3 /, b / b1, b2 /, m(a,b) / a1.b1, a2.b2 /;
$gdxOut load_defines_pairs.gdx
$unload m
$gdxOut
set i, j, ij(i<,j<);
$gdxIn load_defines_pairs.gdx
$load ij=m
$gdxIn
*= card(ij) 2
*= ij('a2','b2') yes
*= card(i) 2
*= card(j) 2
