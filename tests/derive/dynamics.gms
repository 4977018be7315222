$title A reactor by collocation: sums over tuples of the same set, lags inside nonlinear terms, circular ends
sets e 'elements' / e1*e4 /, c 'points' / c0*c2 /, s / A, B /, col(c) / c1, c2 /;
alias (c,k), (s,ss), (e,ee);
table dphi(k,c)
       c1      c2
 c0  -2.0     2.0
 c1   1.5    -4.5
 c2   0.5     2.5 ;
parameter x0(s) / A 1, B 0 /, h(e); h(e) = 0.25;
variables x(e,c,s), u(e), yield; positive variable u;
equations ode(e,c,s), cont(e,s), init(s), obj, smooth(e), period;
ode(e,col(c),s)$sameas(s,"A")..  sum(k, dphi(k,c)*x(e,k,'A')) =e= -h(e)*(u(e) + sqr(u(e))/2)*x(e,c,'A');
cont(e+1,s)..        x(e+1,'c0',s) =e= x(e,'c2',s);
init(s)..            sum(e$(ord(e) = 1), x(e,'c0',s)) =e= x0(s);
equation ode2(e,c);
ode2(e,col(c))..     sum(k, dphi(k,c)*x(e,k,'B')) =e= h(e)*(u(e)*x(e,c,'A') - 0.1*u(e)*x(e,c,'B')**2*u(e--1));
smooth(e)..          power(u(e) - u(e++1),2) =l= 9;
period..             u('e1')*u('e4') =g= exp(-sum(e, u(e))/10);
obj..                yield =e= sum((e,s)$(ord(e) = card(e) and sameas(s,'B')), x(e,'c2',s)) - .001*sum(e, u(e)*u(e));
u.up(e) = 5; u.l(e) = 1; x.l(e,c,s) = .5; x.lo(e,c,s) = 0; x.up(e,c,s) = 2;
model reactor / all /;
solve reactor using nlp maximizing yield;
