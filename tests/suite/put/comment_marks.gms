$eolCom //
* A mark of comments in quotes is text, also directly behind a word.
set i / a don't // the user's choice
  , bb /;
file f / 'marks.txt' /;
put f;
loop(i, put i.tl:2'//' 'x' '//' / // a comment
  ); // that's
putclose;
*|marks.txt| a //x//
*|marks.txt| bb//x//
