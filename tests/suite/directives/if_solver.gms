* `$if solver` asks whether a name is one of a solver, and `$comment` takes a letter for its mark too.
scalar known / 0 /, unknown / 0 /;
$if solver conopt known = 1;
$if not solver no_such_solver unknown = 1;
$comment c
c known = 7;
$comment *
*= known 1
*= unknown 1
