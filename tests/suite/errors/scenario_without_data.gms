* A scenario's parameter that never gets data.
set s / s1*s3 /;  variable z;  equation e;  parameter d / 1 /, sd(s), r(s);
e.. z =e= d;  model m / all /;
set dict / s.scenario.'', d.param.sd, z.level.r /;
solve m using lp min z scenario dict;
*! error 5
