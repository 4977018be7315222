* `betareg` at the ends of its interval, whatever its parameters.
scalar a, b;
a = betareg(1,2e10,3e10);
b = betareg(0,2e10,3e10);
*= a 1
*= b 0
