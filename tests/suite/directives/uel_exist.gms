* `$if uelExist` asks whether a text is a label

scalar a / 0 /, b / 0 /, c / 0 /, d / 0 /;
$if uelExist p1 a = 100;
set i / p1, p2, 'two words' /;
$if uelExist P1 a = a + 1;
$if uelExist 'two words' b = 1;
$if uelExist i c = 1;
$if not uelExist other d = 1;
*= a 1
*= b 1
*= c 0
*= d 1
