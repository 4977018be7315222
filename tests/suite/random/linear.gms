* The numbers of `randlinear`, whose density has the total 1 only over an interval of length 1. Where its arguments, or
* those of `randtriangle`, are refused, a number is drawn all the same.
scalar a, b, c, d, e, f, g, h;
a = randLinear(0, 1, 2);  b = randLinear(0, 1, 2);  c = randLinear(0, 0.5, 2);  d = randLinear(0, -0.4, 2);
e = randLinear(0, 0, 1);  f = randLinear(1, 0.1, 3);  g = randLinear(0, 2, 1);  h = randLinear(0, 1, 1);
option decimals = 8;  display a, b, c, d, e, f, g, h;
option seed = 3141;
a = randLinear(0, 1.5, 2);  b = uniform(0, 1);
a = randLinear(1, 0.5, 1);  c = uniform(0, 1);
a = randTriangle(3, 2, 1);  d = uniform(0, 1);
e = uniform(0, -1);  f = uniform(0, 1);
display b, c, d, f;
*! execution 8
*! execution 10
*! execution 11
*> ----      6 PARAMETER a                    =   0.58608384
*>             PARAMETER b                    =   1.29866601
*>             PARAMETER c                    =   1.06572712
*>             PARAMETER d                    =   0.50227788
*>             PARAMETER e                    =   0.29221212
*>             PARAMETER f                    =   1.47303301
*>             PARAMETER g                    =   0.59146471
*>             PARAMETER h                    =   0.90090710
*>
*> ----     12 PARAMETER b                    =   0.84326671
*>             PARAMETER c                    =   0.30113790
*>             PARAMETER d                    =   0.22405287
*>             PARAMETER f                    =   0.34983050
