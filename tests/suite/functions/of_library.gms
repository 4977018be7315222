* bmod only: functions of `stolib` by names of one's own (`exp`, too); their draws come from the one stream of random numbers
$funcLibIn stolib stodclib
Functions draw    /stolib.dnormal /
          exp     / stolib.dexponential/,
          arrive  /stolib.dpoisson/
          reseed  /stolib.SetSeed/;
function  below 'area on the left' /stolib.cdfNormal/;
function  curve /stolib.pdfnormal/;

set i / i1*i2000 /;
scalar seed, at, again;
seed = reseed(7);
at = draw(50, 10);
seed = reseed(7);
again = draw(50, 10);
abort$(at <> again) 'the seed decides what is drawn', at, again;

parameter w(i), a(i), mean(*);
w(i) = exp(0.25);
a(i) = arrive(3);
abort$sum(i$(a(i) <> floor(a(i)) or a(i) < 0 or w(i) < 0), 1) 'counts and times', a, w;
mean('w') = round(sum(i, w(i)) / card(i));
mean('a') = round(sum(i, a(i)) / card(i));
mean('b') = round(sum(i, sqr(a(i) - 3)) / card(i));

* The word is a name elsewhere.
parameter function(i);
function('i2') = 4;

* With variables: the quantile, where the curve's slope is what Newton needs.
variable x, z;
equation quantile, top;
quantile.. below(x, 50, 10) =e= 0.975;
top..      z =e= curve(x, 50, 10);
model q / quantile, top /;
x.l = 50;
solve q using nlp maximizing z;
scalar p, c;
p = below(60, 50, 10);
c = curve(60, 50, 10);
*= mean('w') 4
*= mean('a') 3
*= mean('b') 3
*= function('i2') 4
*= x.l 69.599639845
*= z.l 0.005844507
*= p 0.841344746
*= c 0.024197072
