* A symbol declared without a domain takes its positions from the file; its first use, after that, changes nothing

set p / a, b /;
table given(p,*)
       x   y
a      1   2
b      3   4;
scalar ten / 10 /;
$gdxOut loaded.gdx
$unload given ten
$gdxOut

parameter shaped, one, h(p);
$gdxIn loaded.gdx
$load shaped=given one=ten
$gdxIn
h(p) = shaped(p,'x') + one;
*= card(shaped) 4
*= h('b') 13
