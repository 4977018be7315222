* A page has 58 lines unless `.ps` says otherwise.
file f / long.txt /;  scalar n;
put f;  n = f.ps;
putclose;
*= n 58
