* `$=` draws once per element.
set i / a, b, c /; parameter p(i); scalar s;
p(i) $= uniform(0,1); s = uniform(0,1); display p, s;
*> ----      3 PARAMETER p
*>
*> a 0.172,    b 0.843,    c 0.550
*>
*> ----      3 PARAMETER s                    =        0.301
