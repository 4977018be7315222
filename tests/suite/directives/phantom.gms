* Data leave out the records that have the label of $phantom: sets that would be empty need no $onEmpty.
$phantom null
set n / a, b, Null 'no element' /
    none(n) / null /
    pairs(n,n) / a.b, null.null, b.null, null.a /
    lone(*) / null, x /
    products / (null,u).(v,null), w.null /;
parameter p(n) / a 3, null 0 /;
table t(n,*)
        x  null
   a    1     0
   null 0     0
   b    5     0;
scalar c;
c = card(n);
*= c 2
*= card(none) 0
*= card(pairs) 1
*= pairs('a','b') yes
*= card(lone) 1
*= card(products) 1
*= products('u','v') yes
*= card(p) 1
*= card(t) 2
