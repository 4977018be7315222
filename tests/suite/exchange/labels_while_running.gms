* A running program gets no new labels: records of a GDX file with labels that it does not have are left out.
set i / a, b /, u(*);  parameter p(*), q(i);  scalar n, m, k;
execute_load 'gams.gdx', p, q = p, u = i;
n = card(p);  m = card(q);  k = card(u);
display n, m, k;
*= n 2
*= m 2
*= k 2
*= p('b') eps
*= u('a') yes
