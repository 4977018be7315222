$title Balancing a matrix by cross entropy: pairs by conditions, margins with errors, logs guarded by data
sets i / a1, a2, a3, a4 /, w / 1*3 /, nonz(i,i);
alias (i,j);
table t0(i,j)
      a1   a2   a3   a4
 a1         5    3
 a2    4         6    2
 a3    2    4
 a4    1         3     ;
parameters tot(i), a0(i,j), v(w) / 1 -1, 2 0, 3 1 /, wbar(w) / 1 .25, 2 .5, 3 .25 /;
tot(j) = sum(i, t0(i,j)) + 0.3*ord(j);
nonz(i,j) = t0(i,j) > 0;
a0(nonz(i,j)) = t0(i,j)/(tot(j) - 0.3*ord(j));
scalar delta / 1e-8 /;
variables a(i,j), err(i), wt(i,w), y(i), dentropy;
equations defe, row(i), colsum(j), errd(i), wsum(i);
defe..        dentropy =e= sum((i,j)$nonz(i,j), a(i,j)*(log(a(i,j) + delta) - log(a0(i,j) + delta)))
                        + sum((i,w)$wbar(w), wt(i,w)*(log(wt(i,w) + delta) - log(wbar(w) + delta)));
row(i)..      y(i) =e= sum(j$nonz(i,j), a(i,j)*(tot(j) + err(j)));
colsum(j)..   sum(i$nonz(i,j), a(i,j)) =e= 1;
errd(i)..     err(i) =e= sum(w, wt(i,w)*v(w));
wsum(i)..     sum(w, wt(i,w)) =e= 1;
a.lo(nonz) = 0; a.up(nonz) = 1; a.l(nonz) = a0(nonz); wt.lo(i,w) = 0; wt.l(i,w) = wbar(w);
y.fx(i)$(ord(i) > 1) = tot(i); y.l(i) = tot(i);
model ent / all /;
solve ent using nlp minimizing dentropy;
display a.l, errd.m;
