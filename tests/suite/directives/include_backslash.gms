* bmod only: models from Windows part folders by backslashes, which GAMS refuses elsewhere

scalar a / 1 /;
$include ..\directives\include_part.inc
*= a 11
*= fromPart 5
scalar there / 0 /;
$if exist ..\directives\include_part.inc there = 1;
*= there 1
