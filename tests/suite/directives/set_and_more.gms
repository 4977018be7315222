* Behind a value in quotes a line of directives goes on, with `$` or without; a value without quotes takes the rest.
$set r 'u1' set c '' set row x y
$if not set zz $set a "1" setGlobal b '2' $set d 3 set e
$set f 'x' goto over
scalar not_reached / 1 /;
$label over
scalar n / 0 /;
$if "%r%|%c%|%row%" == "u1||x y" n = n + 1;
$if "%a%|%b%|%d%" == "1|2|3 set e" n = n + 1;
$if "%f%" == "x" n = n + 1;
*= n 3
