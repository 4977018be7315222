* A loop around one assignment assigns in every turn unless each turn assigns the whole symbol.
set t / 1*3 /, s(t) / 1, 2 /, j / x, y /;  alias(t,u), (j,k);
parameter q(j) / x 4 /, by(j,t), square(t,t), label(t,t), sub(t), star(*), lag(t), two(j,j), whole(t);
by(j,t) = 7;      loop(j, by(j,t) = q(j));
loop(j, square(t,t) = q(j));
loop(j, label('1',t) = q(j));
loop(j, sub(s) = q(j));
loop(j, star(t) = q(j));
lag(t) = 7;       loop(j, lag(t+1) = q(j));
two(j,k) = 7;     loop(j, two(k,j) = q(j));
loop(j, whole(u) = q(j));
*= by('x','1') 4
*= by('y','1') 0
*= by('y','3') 0
*= square('1','1') 0
*= label('1','1') 0
*= sub('1') 0
*= star('1') 0
*= lag('1') 7
*= lag('2') 0
*= two('x','x') 4
*= two('x','y') 0
*= two('y','y') 0
*= whole('1') 4
