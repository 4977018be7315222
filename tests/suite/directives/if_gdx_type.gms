* What a data file holds, asked before it is loaded.
set i / a, b /;
alias (i, j);
parameter p(i) / a 1 /;
scalar c / 3 /;
variable v(i);
equation e(i);
scalar k / 0 /;
$gdxOut if_gdx_type.gdx
$unload i j p c v e
$gdxOut
$gdxIn if_gdx_type.gdx
$if gdxSetType I k = k + 1;
$if gdxSetType j k = k + 2;
$if gdxParType p k = k + 4;
$ifI gdxpartype c k = k + 8;
$if gdxVarType v k = k + 16;
$if gdxEquType e k = k + 32;
$if not gdxParType i k = k + 64;
$if gdxDimension 1 p k = k + 128;
$if gdxDimension 0 c k = k + 256;
$if not gdxDimension 1 nothere k = k + 512;
$ifThen gdxSetType nothere
$load nothere
$endIf
$gdxIn
*= k 1023
