* Switches on a grid: each turns over its own lamp and its neighbours'; all are to go out. None of the whole numbers has an upper bound.
set i 'rows' / 1*5 /;
alias (i,j);
integer variables press(i,j), pairs(i,j);
press.up(i,j) = inf;
pairs.up(i,j) = inf;
variable total;
equations out(i,j), count;
out(i,j)..  press(i,j) + press(i-1,j) + press(i+1,j) + press(i,j-1) + press(i,j+1) =e= 2*pairs(i,j) - 1;
count..  total =e= sum((i,j), press(i,j));
model lamps / all /;
lamps.optCR = 0;
solve lamps using mip minimizing total;
*= lamps.modelstat 1
*= total.l 15
