* Lags on both sides in two and three positions: element by element where all positions behind the first have lags as far, in whatever
* direction; else the right side sees the values from before.
set i / i1*i3 /, j / j1*j3 /, k / k1*k2 /;  parameter p(i,j), c(k,i,j);  set m(i,j);  scalar one / 1 /;
p(i,j) = 10*ord(i) + ord(j);  p(i,j++1) = 2*p(i,j--1);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i,j++2) = 2*p(i,j++1);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i++1,j) = 2*p(i--2,j);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i++1,j--1) = 2*p(i-1,j+2);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i++1,j++2) = 2*p(i++1,j--2);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i,j++one) = 2*p(i,j--one);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i,j++one) = 2*p(i,j--1);  display p;
p(i,j) = 10*ord(i) + ord(j);  p(i,j++ord(i)) = 2*p(i,j--ord(i));  display p;
m(i,j) = ord(i) = 1 or ord(j) = 2;  m(i++1,j++2) = not m(i++2,j--1);  display m;
c(k,i,j) = 100*ord(k) + 10*ord(i) + ord(j);  c(k++1,i,j--1) = c(k,i,j++1);  display c;
c(k,i,j) = 100*ord(k) + 10*ord(i) + ord(j);  c(k++1,i--1,j--1) = c(k,i++2,j++1);  display c;
*> ----      4 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      52.000      26.000      22.000
*> i2      92.000      46.000      42.000
*> i3     132.000      66.000      62.000
*>
*> ----      5 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      26.000      22.000      24.000
*> i2      46.000      42.000      44.000
*> i3      66.000      62.000      64.000
*>
*> ----      6 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      22.000      24.000      26.000
*> i2      42.000      44.000      46.000
*> i3      62.000      64.000      66.000
*>
*> ----      7 PARAMETER p
*>
*>             j3
*>
*> i1      46.000
*> i3      26.000
*>
*> ----      8 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      48.000      96.000      24.000
*> i2      88.000     176.000      44.000
*> i3     128.000     256.000      64.000
*>
*> ----      9 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      52.000      26.000      22.000
*> i2      92.000      46.000      42.000
*> i3     132.000      66.000      62.000
*>
*> ----     10 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      24.000      26.000      22.000
*> i2      44.000      46.000      42.000
*> i3      64.000      66.000      62.000
*>
*> ----     11 PARAMETER p
*>
*>             j1          j2          j3
*>
*> i1      52.000      26.000      22.000
*> i2      88.000     176.000      44.000
*> i3      62.000      64.000      66.000
*>
*> ----     12 SET m
*>
*>             j1          j3
*>
*> i1         YES         YES
*> i2         YES         YES
*>
*> ----     13 PARAMETER c
*>
*>                j1          j2          j3
*>
*> k1.i1     213.000     211.000     212.000
*> k1.i2     223.000     221.000     222.000
*> k1.i3     233.000     231.000     232.000
*> k2.i1     113.000     111.000     112.000
*> k2.i2     123.000     121.000     122.000
*> k2.i3     133.000     131.000     132.000
*>
*> ----     14 PARAMETER c
*>
*>                j1          j2          j3
*>
*> k1.i1     213.000     211.000     212.000
*> k1.i2     223.000     221.000     222.000
*> k1.i3     233.000     231.000     232.000
*> k2.i1     113.000     111.000     112.000
*> k2.i2     123.000     121.000     122.000
*> k2.i3     133.000     131.000     132.000
