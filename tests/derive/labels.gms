$title labels and texts with signs that LaTeX does not take as they are
set i 'Länder → Städte, 5 € ≤ ∞, a | b < c' / 'x$y', '50%', 'a_b', 'c&d', 'e#f', '{g}', '^h', 'π≤', 'ü→ö', '3 €' /;
parameter c(i) '$\alpha$ cost_% #1 [€/m² s⁻¹, CO₂]';
c(i) = ord(i);
positive variable x(i) 'λ rate ^2 ~ \ back';
variable z 'Ω';
equations o 'ε', r(i);
o.. z =e= sum(i, c(i)*x(i)) + 2*x('c&d') + x('π≤');
r(i).. x(i) + x('ü→ö') + x('3 €') + x('x$y') + x('50%') =g= 1;
model m / all /;
solve m using lp minimizing z;
