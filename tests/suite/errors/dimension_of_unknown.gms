* The dimension of what is not declared is no answer (GAMS: 664).
scalar s / 1 /;
$if dimension 0 s s = 2;
$if dimension 1 s2 s = 3;
*! error 4
