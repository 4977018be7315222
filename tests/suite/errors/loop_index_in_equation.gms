* The index of a loop may not run in the equations that are solved in it (GAMS: error 50); an alias may,
* and what another set's index found.
set i / a, b /, s(i) / a /;  alias (i,j);
variable x(i), z;  equation e(i), o, f(i), p;  scalar n / 0 /;
e(i).. x(i) =g= ord(i);
o.. z =e= sum(i, x(i));
f(s).. x(s) =g= 5;
p.. z =e= sum(s, x(s));
model m / e, o /, k / f, p /;
loop(j, solve m using lp minimizing z;  n = n + z.l; );
loop(s(j), solve k using lp minimizing z;  n = n + z.l; );
if (n > 0, solve m using lp minimizing z; );
loop(i, solve m using lp minimizing z; );
*! error 13
loop(s, if (n > 0, solve k using lp minimizing z; ););
*! error 15
