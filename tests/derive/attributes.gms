$title Attributes of variables and equations as data of formulas, labels with blanks and quotes, texts with both
set i "plants 'old' and new" / 'new york' 'the big one', "o'hare" "quote ' inside", 'a-b' 'say "yes"', 4 /, tt / 1960, 1965, 1970 /;
alias (i,ip);
parameter c(i) 'cost' / 'new york' 3, "o'hare" 4.5, 'a-b' 2, 4 1e-3 /, big(i) / 'new york' inf, 'a-b' 7 /, nil(i) / 'a-b' eps /;
positive variables x(i,tt) "amount in 'kg'", slackv(i); variable z 'total "cost"'; scalar total / 20 /;
equations cap(i,tt) 'at most', dem(tt), obj "z = sum", prox(i);
cap(i,tt)..   x(i,tt) =l= x.up(i,tt) - 1 + slackv(i);
dem(tt)..     sum(i, x(i,tt)) =g= total*(tt.val - 1950)/20;
prox(i)$(nil(i) or c(i) > 3)..  sum(tt, x(i,tt)) - sum(tt, x.l(i,tt)) =l= 3*big(i) + slackv(i);
obj..         z =e= sum((i,tt), (c(i) + ord(tt)/10)*x(i,tt)) + 9*sum(i, slackv(i)) + sum(i, nil(i));
x.up(i,tt) = 6 + ord(i); x.l(i,tt) = ord(i) - 1; x.lo('4',tt) = .5;
model m1 'with "quotes"' / all /;
solve m1 using lp minimizing z;
x.up(i,tt) = x.l(i,tt) + 2;
solve m1 using lp minimizing z;
