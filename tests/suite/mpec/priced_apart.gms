* bmod only: what the objective pays in one part of the stationarity program does not count in another
* The price is free, so its row is an equation; the quantity at its bound and the price hang together by the objective alone.
positive variable quantity;  variables price, gap;
equations distance, demand;
distance..  gap =e= sqr(quantity - price);
demand..  2*price - 22 =g= 0;
quantity.up = 10;
model m / distance, demand.price /;
solve m using mpec minimizing gap;
*= m.modelstat 2
*= gap.l 1
*= quantity.l 10
