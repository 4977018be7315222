* `na and 0` is `na`, which counts as true, also where a loop's body changes what the condition reads.
set i / a, b /, s(i) / a /;  parameter p(i) / a 4 /, q(i) / a 4 /, r(i) / a 4 /;  scalar c / 0 /, d / 0 /, e / 0 /;
loop(i$(0 and p('b') < na), c = c + 1;  p(i) = 5);
loop(i$(s(i) and q('b') < na), d = d + 1;  q(i) = 5);
loop(i$(0 and r('b') < na), e = e + 1);
*= c 2
*= d 2
*= e 2
*= p('b') 5
