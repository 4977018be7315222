* Data come before all assignments are carried out: there are none behind an assignment.
set i / a, b /;  parameter q(i);  scalar s;
q(i) = 3;
parameter q(i) / a 1 /;
s = 1;
scalar s / 2 /;
*! error 4
*! error 6
