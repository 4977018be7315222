* `.tf` says what stands for the text of an element: nothing, its label where it has none, its label, its label in quotes.
set r / abc, tt 'text' /, pair(r,r) / abc.tt, tt.abc 'both' /;
alias (r,q);
file out / 'fill.txt' /;
scalar k;
put out;
for(k = 0 to 4,
  out.tf = k;
  loop(r, put r.te(r) '|');
  loop(pair(r,q), put pair.te(r,q) '|');
  put /;
);
putclose;
*|fill.txt| |text||both|
*|fill.txt| abc|text|abc.tt|both|
*|fill.txt| abc|text|abc.tt|both|
*|fill.txt| abc|tt|abc.tt|tt.abc|
*|fill.txt| "abc"|"tt"|"abc","tt"|"tt","abc"|
