* Where a factor has no record the others are not looked at, if only operators stand in them; functions are called.
set i / full, none /;  parameter a(i) / full 2 /, b(i) / full 16 /, e(i) / full 0.5, none -1 /, p(i);  scalar s, t;
p(i) = a(i)*b(i)**(-0.5);
s = sum(i, (3 + b(i)**e(i))*a(i));
t = sum(i, a(i)*mod(5,b(i)));
display p, s, t;
p(i) = a(i)*log(b(i));
display p;
*! execution 7
*> ----      6 PARAMETER p
*>
*> full 0.500
*>
*> ----      6 PARAMETER s                    =       14.000
*>             PARAMETER t                    =       10.000
*>
*> ----      8 PARAMETER p
*>
*> full 5.545,    none  UNDF
