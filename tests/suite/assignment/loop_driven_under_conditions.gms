* A loop passes over turns by the conditions of assignments too, their own or those of loops around them, whatever they assign:
* what stands beside keeps its value.
set i / a, b, c /, j / x, y /, jj(j) / x /, k(j);  alias (i,i2);  set w2(i,j) / b.x /;
parameter a(j), b(j), h(j) / x 1 /, q(i) / b 3 /, r(i) / a 1 /, w(i,j) / b.x 4 /, got(*);  scalar s;  variable v(j);
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j) $= q(i));  got('not zero') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$q(i) = 5);  got('a condition') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$q(i) = r(i));  got('the condition counts') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$h(j) = q(i));  got('a condition without the index') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(not q(i)) = 5);  got('not') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$w(i,j) = 5);  got('a record further back') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(q(i) or h(j)) = 3);  got('or') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(q(i) > 1) = 5);  got('a comparison') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$q(i) = b(j)+1);  got('reads itself') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(q(i) and b(j)) = 1);  got('reads itself in the condition') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(q(i)$b(j)) = 1);  got('reads itself behind the condition') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j) $= q(i)*b(j));  got('reads itself, not zero') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b('x')$q(i) = 5);  got('a label') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(jj)$q(i) = 5);  got('a subset') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j+1)$q(i) = 5);  got('a lag') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); s$q(i) = 5);  got('a scalar') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); s = q(i));  got('a scalar without') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); v.l(j)$q(i) = 5);  got('an attribute') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); k(j)$q(i) = no);  got('a set') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$q(i) = uniform(0,1));  got('drawn') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(q(i) > uniform(0,1)) = 4);  got('drawn in the condition') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$sameas(i,'b') = 1);  got('sameas') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); b(j)$(ord(i) = 2) = 5);  got('ord') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(i2$q(i), b(j) = 5));  got('a loop under a condition') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(i2, b(j)$q(i) = 5));  got('a condition in a loop') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(i2$q(i2), b(j) = q(i)));  got('a value in a loop') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(i2, b(j) = q(i2)));  got('a value of the other loop') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(w2(i,j), s = 5));  got('a tuple set') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(i2$(q(i) or r(i2)), s = 1));  got('or of a loop') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); loop(i2, b(j)$q(i) = 5; s = 1));  got('one without a condition') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); if(s, b(j)$q(i) = 3 else b(j)$q(i) = 4));  got('if and else') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); while(s > 7, s$q(i) = 1));  got('while') = a('y');
a(j) = 9; b(j) = 0; b('x') = 7; s = 7; k(j) = yes; v.l(j) = 1;  loop(i, a(j) = q(i); for(s = 1 to 2, b(j)$q(i) = 3));  got('for') = a('y');
*= got('not zero') 3
*= got('a condition') 3
*= got('the condition counts') 3
*= got('a condition without the index') 0
*= got('not') 0
*= got('a record further back') 3
*= got('or') 0
*= got('a comparison') 3
*= got('reads itself') 3
*= got('reads itself in the condition') 0
*= got('reads itself behind the condition') 3
*= got('reads itself, not zero') 0
*= got('a label') 3
*= got('a subset') 3
*= got('a lag') 3
*= got('a scalar') 3
*= got('a scalar without') 0
*= got('an attribute') 3
*= got('a set') 3
*= got('drawn') 3
*= got('drawn in the condition') 0
*= got('sameas') 3
*= got('ord') 0
*= got('a loop under a condition') 3
*= got('a condition in a loop') 3
*= got('a value in a loop') 3
*= got('a value of the other loop') 0
*= got('a tuple set') 3
*= got('or of a loop') 0
*= got('one without a condition') 0
*= got('if and else') 3
*= got('while') 3
*= got('for') 0
