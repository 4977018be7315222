* Inside a block, too, a keyword that begins a statement ends the one before it.
set t / 1*4 /;  scalar a / 0 /, b / 0 /, c / 0 /;  file f / 'f.txt' /;  put f;
loop(t, a = a + 1
  execute_unload 'a.gdx', a);
loop(t, b = b + 1
  break$(b = 2));
loop(t, c$(ord(t) > 1) = c + 1
  continue$(c > 1)
  put t.tl:0
  put_utility 'log' / 'x');
putclose;
execute_load 'a.gdx', c = a;
*= a 4
*= b 2
*= c 4
*|f.txt| 1
*|f.txt| 2
