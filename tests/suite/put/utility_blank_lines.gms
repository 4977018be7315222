* Blank lines of put_utility count for nothing; sleep gives the seconds it would take.
file f / utility_one.txt /;
put f 'one' /;
put_utility 'ren' / / 'utility_two.txt' / ' ' / 'log' / '' / 'said';
put 'two' /;
putClose;
scalar a;
a = sleep(0.25);
*|utility_one.txt| one
*|utility_one.txt|
*|utility_two.txt| two
*= a 0.25
