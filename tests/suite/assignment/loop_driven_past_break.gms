* `break`, `continue` and options among a loop's assignments are passed over with the turn, so that a `break` there ends nothing.
set i / a, b, c /, j / x, y /, k(i), m(i,j);  parameter a(j), h(j), q(i) / b 3 /, r(i) / a 1 /, z(i), w(i,j) / b.x 4 /, got(*);  scalar s;  z(i) = 0;
a(j) = 9; h(j) = 1; s = 0;  loop(i, break$(ord(i)=1); a(j)$q(i) = 5);  got('break ahead') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j)$q(i) = 5; break$(ord(i)=1));  got('break behind') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, break$(ord(i)=2); a(j)$q(i) = 5);  got('break in the turn') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, if(ord(i)=1, break); a(j)$q(i) = 5);  got('break in if') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, break$(ord(i)=1); a(j) = q(i));  got('break and a value') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, break$(ord(i)=1); a(j) = q(i)+1);  got('break and a sum') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, break$r(i); a(j)$q(i) = 5);  got('break by a record') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, if(ord(i)=1, loop(j, break 2)); a(j)$q(i) = 5);  got('break of both') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); loop(j, break$(a(j) > 100)));  got('break of a loop within') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j)$q(i) = 5; loop(j$(ord(i)=1), break); break$(ord(i)=1));  got('break of a loop under a condition') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j)$q(i) = 5; loop(j$(ord(j)=1), break); break$(ord(i)=1));  got('break of a loop under a condition on another') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j)$q(i) = 5; loop(j$r(i), s$r(i) = 5; break));  got('break of a loop under a record') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); loop(j$r(i), break));  got('break alone under a record') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, continue$(ord(i)=1); a(j) = q(i));  got('continue ahead') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, if(ord(i)=3, continue); a(j) = q(i));  got('continue in if') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); loop(j, continue));  got('continue of a loop within') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); loop(j$(ord(i)=2), continue));  got('continue of a loop under a condition') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); while(s < 0, break));  got('while and break') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); option decimals = 3);  got('decimals') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); option clear = h);  got('clear') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); option k < w);  got('project') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); option m(i:j));  got('match') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); option a:0);  got('format') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); option seed = 5);  got('seed') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = w(i,j); option clear = w);  got('clear what drives') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j)$q(i) = 5; option clear = h);  got('clear under a condition') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, h('x') = 2; a(j)$z(i) = 5; option clear = h);  got('clear what nothing drives') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); display$(0) i);  got('display') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, a(j) = q(i); abort$(0) 'no');  got('abort') = a('y') + 100*h('x') + s/10;
a(j) = 9; h(j) = 1; s = 0;  loop(i, break$(ord(i)=3); a(j) = q(i); s = 3);  got('a scalar beside') = a('y') + 100*h('x') + s/10;
*= got('break ahead') 105
*= got('break behind') 105
*= got('break in the turn') 109
*= got('break in if') 105
*= got('break and a value') 103
*= got('break and a sum') 109
*= got('break by a record') 105
*= got('break of both') 105
*= got('break of a loop within') 103
*= got('break of a loop under a condition') 109
*= got('break of a loop under a condition on another') 109
*= got('break of a loop under a record') 105.5
*= got('break alone under a record') 103
*= got('continue ahead') 103
*= got('continue in if') 103
*= got('continue of a loop within') 103
*= got('continue of a loop under a condition') 100
*= got('while and break') 103
*= got('decimals') 103
*= got('clear') 3
*= got('project') 103
*= got('match') 103
*= got('format') 103
*= got('seed') 103
*= got('clear what drives') 100
*= got('clear under a condition') 5
*= got('clear what nothing drives') 9
*= got('display') 100
*= got('abort') 100
*= got('a scalar beside') 103.3
