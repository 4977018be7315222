* bmod only: a price of 5e-5 is shown beside an active penalty of 1e9.

*= m.modelstat 1
*= water.m 0.00005
*= capacity.m -999999999.995
positive variables buy, short; variable z;
equations cost, demand, capacity, water;
positive variable use;
cost.. z =e= 1e9*short + 5e-5*use;
demand.. buy + short =g= 10;
capacity.. buy =l= 8;
water.. use =g= 100*buy;
model m /all/;
solve m using lp minimizing z;
