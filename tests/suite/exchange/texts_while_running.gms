* While the model runs, loading brings no explanatory text for the symbol; the texts of elements come.
set i 'an i' / a 'first', b /;
parameter p(i) 'a p' / a 1 /;
execute_unload 'texts.gdx', i, p;
set k;
parameter q(*);
execute_load 'texts.gdx', k = i, q = p;
file out / 'texts.txt' /;
put out '<' k.ts '|' q.ts '|';
loop(i, put k.te(i) '|');
putclose;
*|texts.txt| <||first|b|
