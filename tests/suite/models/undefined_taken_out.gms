* A model may name an equation that is not defined, if a later item takes it out.
variable x, z;
equation def, low, later;
def.. z =e= x;
low.. x =g= 1;
model m / all - later /, n / def, later /, k / n - later, low /;
solve m using lp minimizing z;
scalar a; a = z.l;
z.l = 0;
solve k using lp minimizing z;
*= a 1
*= z.l 1
*= k.modelstat 1
