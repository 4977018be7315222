* A converter is not started: the file that it made before is read, with a warning.
set i / a, b, c /;
parameter p(i);
$call =gdxxrw.exe data.xlsx o = ../exchange/gams.gdx par=p rng=data!A1:B4
$call csv2gdx "no such file.csv" id=d index=1 output="../exchange/gams.gdx" useHeader=y
scalar here;
$ifThen exist ../exchange/gams.gdx
here = 1;
$endIf
*= here 1
