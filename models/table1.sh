#!/bin/sh
# Table 1 of Ferris & Tin-Loi (2001): load factors of six walls by LP (8), MCP (7) and MPEC (10), the paper's
# figures beside them. usage: models/table1.sh [bmod [OUTPUT_DIRECTORY]]
# Prints the table; table1.txt, table1.csv and table1.md are in the output directory.
set -e
bmod=${1:-bmod}
out=${2:-.}
walls=$(dirname "$0")/walls
mkdir -p "$out"
cat > "$out/table1.txt" <<'END'
                        LP    paper   secs           MCP    paper   secs          MPEC    paper   secs % diff paper residual      y'z (in 1e-15)
END
echo 'example,blocks,contacts,lp,lp_paper,lp_seconds,mcp,mcp_paper,mcp_seconds,mpec,mpec_paper,mpec_seconds,difference,difference_paper,residual,signs,product' > "$out/table1.csv"
cat > "$out/table1.md" <<'END'
| | b × c | LP (paper) | s | MCP (paper) | s | MPEC (paper) | s | % diff (paper) | residual, 1e-15 | y'z, 1e-15 |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
END
for k in 1 2 3 4 5 6; do
    "$bmod" run "$walls/table.blk" -D example=$k --out "$out" --quiet
    for kind in txt csv md; do
        cat "$out/table1_$k.$kind" >> "$out/table1.$kind"
        rm "$out/table1_$k.$kind"
    done
done
cat "$out/table1.txt"
