* A zero without a running index leaves out nothing: the factor beside it is evaluated, and its error reported. Only where
* the record of a running index is absent is the tuple passed over.
set i / a, b /;
parameter q(i) / b 1 /, r(i) / a -2, b -2 /, byscalar(i), bylabel(i), byindex(i), bypart(i);
scalar z / 0 /, s, n;
byscalar(i) = z * r(i)**2;
bylabel(i) = r(i)**2 * q('a');
byindex(i) = r(i)**2 * q(i) * 0;
bypart(i) = log2(z) * q(i);
s = sum(i, r(i)**2 * z);
n = sum(i$(ord(i) = 1), r(i)**2 * q(i));
*= byscalar('a') undf
*= byscalar('b') undf
*= bylabel('a') undf
*= byindex('a') 0
*= byindex('b') undf
*= bypart('a') 0
*= bypart('b') undf
*= s undf
*= n 0
*! exit 3
