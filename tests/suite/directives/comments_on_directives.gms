$eolCom //
$inlineCom { }
* Comments may stand on lines of directives, as on any line; in quotes they are text.
$set a yes // not in the value
$setGlobal b 'it' // nor here
$set c // nothing
$set d 'x // y' // but this
$set e { before } left { behind }
$eval n 6/2//three
$macro twice(x) 2*x \
  + 1 // a comment behind a macro
$if set a $set f g // with a condition
$ifThenE %n%-1==2 // a number
scalar three / 1 /;
$elseIf x == y // not reached
$endIf
$onEcho > comments_on_directives.inc // a file
scalar read / 1 /; // of the text
$offEcho // end
$include comments_on_directives.inc // read
$setEnv BMOD_SUITE on // set
scalar k / 0 /;
$if "%a%|%b%|%c%|%d%|%e%" == "yes|it||x // y|left" k = k + 1;
$if "%f%|%sysEnv.BMOD_SUITE%|%n%" == "g|on|3" k = k + 1;
scalar m;  m = twice(3);
*= three 1
*= read 1
*= k 2
*= m 7
* Every quote begins a text there, also directly behind a letter; one without its partner reaches to the end.
$set h x'//'y // not in the value
$set i don't // stop
scalar quotes / 0 /;
$if "%h%" == "x'//'y" quotes = quotes + 1;
$if "%i%" == "don't // stop" quotes = quotes + 1;
*= quotes 2
* Marks in the value of a `%name%` begin no comment.
$set j 'http://x'
$set l %j% // c
$setGlobal m a%l%b
$log %j%
scalar values / 0 /;
$if "%l%|%m%" == "http://x|ahttp://xb" values = values + 1;
$if not %j% == y values = values + 1;
*= values 2
