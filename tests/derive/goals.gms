$title Goals with priorities, weights computed by smin and smax over data, nested sums, products
set g / g1*g3 /, x / x1*x5 /, lev / a, b /, gl(g,lev) / g1.a, g2.a, g3.b /;
table c(g,x)
      x1  x2  x3  x4  x5
 g1    3  -1   2   4   1
 g2    1   5   2   0   2
 g3    2   2  -3   1   4 ;
parameter goal(g) / g1 20, g2 18, g3 9 /, prior(lev) / a 100, b 1 /, norm(g);
norm(g) = smax(x$c(g,x), abs(c(g,x)))/smin(x$(c(g,x) <> 0), abs(c(g,x)));
positive variables v(x), n(g), p(g); variable obj, spread;
equations dev(g), budget, chain(x), last, o;
dev(g)..       sum(x, c(g,x)*v(x)) + n(g) - p(g) =e= goal(g);
budget..       sum(x, prod(g$(c(g,x) > 0), 1 + c(g,x)/10)*v(x)) =l= 12 + smin(g, goal(g));
chain(x)$(ord(x) < card(x)).. v(x+1) - v(x) =l= max(2, min(ord(x),3));
last..         sum(x$(ord(x) = card(x)), v(x)) =e= spread;
o..            obj =e= sum(lev, prior(lev)*sum(gl(g,lev), (n(g) + 0.5*p(g))/norm(g))) - 0.01*spread;
spread.lo = -1; spread.up = 5;
model goalp / all /;
solve goalp using lp minimizing obj;
solve goalp using lp minimizing obj;
