* A semicolon may follow a file name in quotes.
$onEcho > 'include_semicolon.inc';
scalar a / 1 /;
$offEcho
$echo "scalar b / 2 /;" > "include_semicolon2.inc" ;
$include 'include_semicolon.inc';
$ifI not exist 'nothing.inc'  $include  "include_semicolon2.inc";;
*= a 1
*= b 2
