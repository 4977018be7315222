* A set is nothing to write: its element's label is, or its text.
set i / a 'first', b /;
file f / 'put_set.txt' /;  put f;
loop(i, put i.tl i.te(i):8 /);
loop(i, put i /);
*! error 5
