* `$if putOpen`: whether a `put` has named a file; `putclose` does not take that back (asked of GAMS).
scalar before / 0 /, after / 0 /, closed / 0 /;
file f / 'put_open.txt' /;
$if putOpen before = 1;
put f;
$if putOpen after = 1;
put 'x' /;
putclose f;
$if putOpen closed = 1;
*= before 0
*= after 1
*= closed 1
