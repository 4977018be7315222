* $splitOption takes the key and the value of an option apart.
scalar k / 0 /;
$splitOption -Key=value a b
$if "%a%|%b%" == "Key|value" k = k + 1;
$splitOption "/key some words" a b
$if "%a%|%b%" == "key|some words" k = k + 1;
$splitOption "-key = 'in quotes'" a b
$if "%a%|%b%" == "key|in quotes" k = k + 1;
$splitOption -x=y=z a b
$if "%a%|%b%" == "x|y=z" k = k + 1;
$splitOption --y= a b
$if "%a%|%b%" == "-y|" k = k + 1;
$splitOption no=option a b
$if "%a%|%b%" == "|" k = k + 1;
*= k 6
