* A parameter declared over `i<` defines the set with data that a later statement gives, too.
Set i;
Parameter p(i<);
Parameter p / a 1, b 2 /;
*= card(i) 2
*= p('a') 1
*= p('b') 2
