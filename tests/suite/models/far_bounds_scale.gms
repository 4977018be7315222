* bmod only: bounds of 1e11 that stand for "no limit" do not set the scale of the rows.

*= m.modelstat 1
*= z.l 0.9485413281
positive variables x0,x1,x2,x3,x4,x5,x6,x7; variable z; equations obj,r0,r1;
x0.up=1e11;
x1.up=1e11;
x2.up=1e11;
x3.up=1e11;
x4.up=1e11;
x5.up=1e11;
x6.up=1e11;
x7.up=1e11;
obj.. z =e= 3.85*x0+8.89*x1+7.46*x2+7.76*x3+2.14*x4+2.75*x5+5.95*x6+7.95*x7;
r0.. 4.6*x0+7.51*x1+5.81*x2+1.03*x3+8.78*x4+8.3*x5+4.03*x6+7.5*x7 =g= 2.63;
r1.. 6.16*x0+6.13*x1+4.13*x2+7.82*x3+2.02*x4+2.44*x5+5.55*x6+6.81*x7 =g= 1.18;
model m /all/; solve m using lp minimizing z;
