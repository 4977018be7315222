* Solves in the background: their solutions are there when they are collected, in any order

set s / s1, s2, s3 /;
parameter d(s) / s1 3, s2 5, s3 2 /, h(s), got(s), stat(s), before(s), order(s);
scalar need, n / 0 /;
positive variable x; variable z;
equation cost, enough;
cost.. z =e= 2*x;
enough.. x =g= need;
model m / all /;
m.solveLink = %solveLink.asyncGrid%;
z.l = -7;
loop(s,
   need = d(s);
   solve m min z using lp;
   h(s) = m.handle;
   before(s) = z.l;
);
*= before('s1') -7
*= before('s3') -7

repeat
   loop(s$handleCollect(h(s)),
      got(s) = z.l;
      stat(s) = m.modelStat;
      n = n + 1;
      order(s) = n;
      display$handleDelete(h(s)) 'not deleted';
      h(s) = 0;
   );
   display$sleep(card(h)*0.1) 'waiting';
until card(h) = 0 or timeElapsed > 20;
*= got('s1') 6
*= got('s2') 10
*= got('s3') 4
*= stat('s2') 1
*= card(order) 3

scalar a, b, c, e, kept;
* One solve of them, and the last one of all without.
need = 9;
solve m min z using lp;
h('s1') = m.handle;
need = 99;  x.up = 50;
solve m min z using lp;
kept = m.modelStat;
a = readyCollect(h, 10);
a = handleStatus(h('s1'));
b = handleCollect(h('s1'));
e = z.l;
c = handleStatus(0);
*= a 2
*= b 1
*= c 0
*= kept 1
*= card(h) 1
*= e 18
m.solveLink = 0;
need = 1;
solve m min z using lp;
*= z.l 2
