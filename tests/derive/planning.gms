$title Production and stocks over periods with machines of several vintages
$onText
Leads and lags with conditions by ord and card, initial stocks as data of the first period, a terminal condition,
vintages through a triangular sum.
$offText
Sets t 'periods' / 2001*2006 /, tf(t) 'first', tl(t) 'last', p 'products' / cloth, yarn, thread /, m 'machines' / loom, spindle /;
Alias (t,v);
tf(t) = yes$(ord(t) eq 1);
tl(t) = yes$(ord(t) eq card(t));
Table a(m,p) 'hours per unit'
            cloth  yarn  thread
   loom       2     0.5
   spindle          1.5   0.8 ;
Table demand(p,t)
           2001 2002 2003 2004 2005 2006
   cloth    40   45   52   50   58   61
   yarn     30   28   33   41   38   35
   thread   12   14   11   10   16   18 ;
Parameters s0(p) / cloth 5, yarn 3 /, price(m) / loom 12, spindle 7 /, cap0(m) / loom 100, spindle 80 /, h(p) / cloth .4, yarn .3, thread .2 /, df(t), life(m) / loom 3, spindle 2 /;
df(t) = 1.08**(-(ord(t) - 1));
Scalar scrap / 0.3 /, gamma / 1.5 /;
Positive Variables x(p,t), s(p,t), inv(m,t), cap(m,t), late(p,t);
Free Variable cost;
Equations bal(p,t), final(p), hours(m,t), capd(m,t), service(t), obj;
bal(p,t)..    s(p,t) =e= s(p,t-1) + s0(p)$tf(t) + x(p,t) - demand(p,t) + late(p,t) - late(p,t-1);
final(p)..    sum(tl, s(p,tl)) =g= s0(p);
hours(m,t)..  sum(p$a(m,p), a(m,p)*x(p,t)) =l= cap(m,t);
capd(m,t)..   cap(m,t) =e= cap0(m)*(1 - (ord(t) - 1)/card(t)) + sum(v$(ord(v) <= ord(t) and ord(t) - ord(v) < life(m)), inv(m,v)*gamma);
service(t)$(not tf(t)).. sum(p, late(p,t)) =l= 0.2*sum(p, late(p,t-1)) + 4;
obj..         cost =e= sum((m,t), df(t)*price(m)*inv(m,t)) + sum((p,t), df(t)*(h(p)*s(p,t) + 2*late(p,t)))
                       - scrap*sum(m, price(m)*sum(tl, inv(m,tl)));
inv.up(m,t) = 20;
late.fx(p,tl) = 0;
Model plan / all /;
option lp = simplex, limrow = 0, limcol = 0;
Solve plan using lp minimizing cost;
Parameter rep(*,t);
rep('stock',t) = sum(p, s.l(p,t));
rep('worth',t) = sum(p, bal.m(p,t));
display x.l, rep;
