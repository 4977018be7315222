* A solution that rounding leaves beyond its bounds ends the search (it divided its node for ever).
option optcr = 0, optca = 0, reslim = 20;
set i /i1*i4/, j /j1*j4/, t /t1*t5/, it /n1*n3/; alias(i,ii),(t,u);
set ij(i,j), si(i), dt(t);
parameter a(i,j),b(i),c(j),d(t),g(i); scalar k /4.599/;
option seed=9912; a(i,j)=round(uniform(-3,9),3); b(i)=round(uniform(1,20),3); c(j)=round(uniform(-5,9),3); d(t)=round(uniform(0.2,7),3); g(i)=round(normal(0,3),3);
ij(i,j)=uniform(0,1)<1.1; si(i)=g(i)>0; dt(t)=ord(t)>1;
a(i,j)$(uniform(0,1)<0.3) = 0;
binary variable x(i,j); free variable y(t); variable z, w(i);
w.lo(i)=-6.5; w.up(i)=8.25;
y.lo(t)=-5.5; y.up(t)=6.125; 
equation e0, e1, e2(t), e3(i), e4(t), obj;
e0.. sum((i,j)$a(i,j), a(i,j)*x(i,j)) + sum(i,w(i)) =e= 12.647;
e1.. sum((i,j)$(ord(i)<>ord(j)), a(i,j)*x(i,j)) + w("i1") =l= 21.015;
e2(t)$(ord(t)>1).. y(t) - sum(u$(ord(u)<ord(t)), y(u)) =e= d(t);
e3(si).. w(si) =l= (-7.209) + sum(j, x(si,j))*0.369;
e4(t)$dt(t).. y(t) - y(t-1) =g= -1;
obj.. z =e= sum((i,j), c(j)*x(i,j)*1.580) + sum(i, g(i)*w(i)) + sum(t, (d(t)-3)*y(t)) + (-4.905) + 0.123*sum((i,j), (ord(i)+0.37*ord(j))*x(i,j));
model m /e0,e1,e2,e3,e4,obj/;
m.holdfixed = 1;
solve m minimizing z using mip;
*= z.l -20.71584175
*= m.modelstat 1
