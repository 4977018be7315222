* A list of `execute_unload` ends where a statement begins, also inside a loop

set i / i1, i2 /;
parameter a(i), b(i);
a(i) = ord(i);
loop(i,
   execute_unload 'half.gdx' a
   execute_load 'half.gdx' b = a
   display b
   execute_unload 'other.gdx', a, b
   if(ord(i) = 1, a(i) = 7);
);
*= b('i1') 7
*= b('i2') 2
