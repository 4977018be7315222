$title Open pit: precedence through leads in three directions, and a time index
set l 'level' / 1*3 /, i / 1*4 /, j / 1*3 /, t / y1*y3 /, blk(l,i,j);
alias (t,tt);
blk(l,i,j) = ord(i) <= card(i) - ord(l) + 1 and ord(j) <= card(j) - ord(l) + 1;
parameter conc(l,i,j), cost(l) / 1 1, 2 2, 3 4 /, disc(t);
conc(blk(l,i,j)) = mod(7*ord(l) + 3*ord(i) + 5*ord(j), 9);
disc(t) = 1/(1.1**(ord(t)));
positive variable x(l,i,j,t), cum(l,i,j,t); free variable profit;
equations pre(l,i,j,t), pre2(l,i,j,t), cumd(l,i,j,t), once(l,i,j), capt(t), pdef;
cumd(blk(l,i,j),t)..  cum(l,i,j,t) =e= sum(tt$(ord(tt) le ord(t)), x(l,i,j,tt));
pre(l+1,i,j,t)$blk(l+1,i,j)..   cum(l+1,i,j,t) =l= cum(l,i,j,t);
pre2(l,i,j,t)$(blk(l,i,j) and ord(l) > 1)..  cum(l,i,j,t) =l= cum(l-1,i+1,j+1,t);
once(blk)..           sum(t, x(blk,t)) =l= 1;
capt(t)..             sum(blk, x(blk,t)) =l= 6;
pdef..                profit =e= sum((blk(l,i,j),t), disc(t)*(conc(blk) - cost(l))*x(blk,t));
x.up(l,i,j,t) = 1;
model pit / all /;
solve pit maximizing profit using lp;
