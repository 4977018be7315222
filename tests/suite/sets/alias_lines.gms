* Between groups of aliases a line break does what a comma does.
set plant / p1*p3 /, town / t1*t2 /;
alias (plant, p)
      (town, t), (plant, q)
      (town, u);
scalar pairs; pairs = sum((p,t), 1) + 10*sum((q,u)$(ord(q) > ord(u)), 1);
*= pairs 36
