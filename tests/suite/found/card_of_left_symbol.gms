* `card` of the symbol that is being assigned.
set i / a, b, c /, s(i) / a /; parameter p(i) / a 1, b 2 /;
p(i) = card(p); display p;
s(i) = card(s) = 1; display s;
*> ----      3 PARAMETER p
*>
*>                       ( ALL       0.000 )
*>
*> ----      4 SET s
*>
*>                                                       ( EMPTY )
