* A variable that an equation of its own holds at a bound has one marginal for both: the equation has it, as a decomposition
* expects, and not the difference of two huge numbers.

set i / a, b, c /;
parameter at(i) / b 1, c 1 /;
binary variable y(i);  positive variable x(i);  variable cost;
equations total, held(i), enough(i);
total..     cost =e= sum(i, 12*y(i) + ord(i)*sqr(x(i)));
held(i)..   y(i) =e= at(i);
enough(i).. x(i) + 3*y(i) =g= 4;
model m / all /;
parameter of_row(*,i), of_bound(*,i);

solve m using rminlp minimizing cost;
of_row('convex',i) = held.m(i);  of_bound('convex',i) = y.m(i);
*= of_row('convex','a') -12
*= of_row('convex','c') -6
*= of_bound('convex','a') 0
*= of_bound('convex','b') 0
*= of_bound('convex','c') 0

solve m using rmiqcp minimizing cost;
of_row('qcp',i) = held.m(i);  of_bound('qcp',i) = y.m(i);
*= of_row('qcp','a') -12
*= of_row('qcp','c') -6
*= of_bound('qcp','c') 0

equation curved(i);
curved(i).. x(i) + 3*y(i) - 0.1*exp(y(i)) =g= 4;
model n / total, held, curved /;
solve n using rminlp minimizing cost;
of_row('curved',i) = held.m(i);  of_bound('curved',i) = y.m(i);
*= of_row('curved','a') -11.78
*= of_row('curved','b') -1.879063219
*= of_row('curved','c') -8.818594828
*= of_bound('curved','c') 0

* one that is fixed has nothing else that holds it
y.fx('a') = 0;
solve m using rminlp minimizing cost;
of_bound('fixed',i) = y.m(i);
*= of_bound('fixed','a') -12

* also where all is linear, if it is solved as a nonlinear program; a linear one is solved to a vertex, which says who has it
y.up('a') = 1;
equation flat;
flat.. cost =e= sum(i, 12*y(i) + ord(i)*x(i));
model l / flat, held, enough /;
solve l using rminlp minimizing cost;
of_row('nlp',i) = held.m(i);  of_bound('nlp',i) = y.m(i);
*= of_row('nlp','a') 9
*= of_bound('nlp','a') 0
