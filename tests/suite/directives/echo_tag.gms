* `$onEcho.tag` and `$onPut.tag` end at the directive with that tag; others inside are text.
$onEcho > echo_tag.gms.inc
scalar a / 1 /;
$offEcho.no
$offEcho
$onEcho.Outer > echo_tag2.inc
scalar b / 2 /;
$onEcho > echo_tag3.inc
scalar c / 3 /;
$offEcho
$offEcho.outer
$include echo_tag2.inc
$include echo_tag3.inc
file f / echo_tag.txt /;
put f;
$onPut.q
$offPut
last
$offPut.Q
putClose;
*= b 2
*= c 3
*|echo_tag.txt| $offPut
*|echo_tag.txt| last
