* GAMS lets numbers outside the range of an option pass: they are passed over with a warning, as are names that mean nothing here.
option reslim = -1, optca = -3, iterlim = -1, bratio = 5, limrow = -1, threads = 4, real1 = 2;
variable z;  equation e;  e.. z =e= 1;  model m / e /;
solve m using lp minimizing z;
*= z.l 1
*= m.modelstat 1
*= m.solvestat 1
