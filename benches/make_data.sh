#!/bin/sh
# Writes a model with a parameter of many records as text (2400000 by default, about 50 MB) to standard output:
#    benches/make_data.sh > /tmp/big.blk
awk -v n="${1:-2400000}" 'BEGIN {
   side = int(sqrt(n)) + 1
   printf "Sets i / i1*i%d /, j / j1*j%d /;\nParameter p(i,j) /\n", side, side
   for (r = 0; r < n; r++) printf "i%d.j%d %.6f\n", int(r/side) + 1, r % side + 1, (r*7919 % 1000003)/997
   printf "/;\nScalars total, records;\ntotal = sum((i,j), p(i,j));\nrecords = card(p);\ndisplay total, records;\n"
}'
