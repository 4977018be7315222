$title Input, output, trade: an economy with several rows that hold the objective
sets i 'sectors' / agric, indus, serv /, t(i) 'traded' / agric, indus /, f / labor, capital /;
alias (i,j);
table a(i,j)
         agric  indus  serv
 agric    .10    .05   .01
 indus    .20    .25   .15
 serv     .05    .15   .10 ;
table b(f,j)
          agric indus serv
 labor     .50   .25  .60
 capital   .30   .55  .20 ;
parameters ybar(f) / labor 100, capital 80 /, d(i) / agric 30, indus 30, serv 40 /, pw(t) / agric 1, indus 1.2 /;
variables x(i), e(i), m(i), cons(i), welfare, scale;
positive variables x, e, m, cons;
equations mb(i), res(f), trade, share(i), low, high;
mb(i)..     x(i) + m(i)$t(i) =g= sum(j, a(i,j)*x(j)) + cons(i) + e(i)$t(i);
res(f)..    sum(j, b(f,j)*x(j)) =l= ybar(f);
trade..     sum(t, pw(t)*(0.9*e(t) - m(t))) =g= 0;
share(i)..  cons(i) =g= d(i)*scale;
low..       welfare =l= scale + 0.001*sum(i, cons(i));
high..      2*welfare =l= 3 + scale;
m.up(i) = 25; x.lo(i) = 1;
model econ / all /;
solve econ maximizing welfare using lp;
parameter price(i); price(i) = mb.m(i)/abs(trade.m + 1e-9);
display price;
