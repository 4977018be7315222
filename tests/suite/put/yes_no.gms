* `put yes` writes a membership, as wide as sets are.
file f / yes.txt /;  set i / a /;
put f yes no 'x' / yes:5 no:5 '|' i('a') /;
putclose f;
*|yes.txt|          YES          NOx
*|yes.txt|   YES   NO|         YES
