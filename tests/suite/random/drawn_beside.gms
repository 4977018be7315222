* Random numbers in a condition are drawn where the value beside it has records, found without lags and by indices that
* come once; beside a number, though it is 0, for every element.
set i / a, b, c, d, e /;
parameter q(i) / b 1, c 3, e 2 /, m(i,i) / a.b 1, a.d 2, c.a 3, d.a 1, b.e 4, e.e 1 /, p(i), next(*);  scalar zero / 0 /;
option seed = 3141;  p(i) = 0$uniform(0,1);                            next('number') = uniform(0,1);
option seed = 3141;  p(i) = zero$uniform(0,1);                         next('scalar') = uniform(0,1);
option seed = 3141;  p(i) = q(i)$uniform(0,1);                         next('records') = uniform(0,1);
option seed = 3141;  p(i) = (m('a',i) and q(i++1))$uniform(0,1);       next('lag beside') = uniform(0,1);
option seed = 3141;  p(i) = m(i,i)$uniform(0,1);                       next('index twice') = uniform(0,1);
option seed = 3141;  p(i) = (m('a',i)$uniform(0,1) and zero);          next('in an and') = uniform(0,1);
*= next('number') 0.224052867
*= next('scalar') 0.224052867
*= next('records') 0.301137904
*= next('lag beside') 0.550375356
*= next('index twice') 0.224052867
*= next('in an and') 0.550375356
