* `randbinomial` takes one number, from the most probable count down to 0, then up; none for a probability up to 1e-4 or from 1 - 1e-4.
set k / 1*8 /;  parameter b(k,*);  scalar a;
b(k,'10') = randbinomial(10, 0.3);  b(k,'7') = randbinomial(7, 0.8);  b(k,'2000') = randbinomial(2000, 0.25);
b(k,'3') = randbinomial(3, 0.25);  b(k,'1') = randbinomial(100, 1);  b(k,'0') = randbinomial(100, 1e-5);
a = uniform(0, 1);
option decimals = 0;  display b;  option decimals = 6;  display a;
*> ----      6 PARAMETER b
*>
*>             1           3           7          10        2000
*>
*> 1         100                       6           3         493
*> 2         100                       5           4         488
*> 3         100           1           7           1         508
*> 4         100                       5           2         472
*> 5         100                       7           2         480
*> 6         100           1           3           3         481
*> 7         100           1           6           2         494
*> 8         100                       5           5         493
*>
*> ----      6 PARAMETER a                    =     0.160173
