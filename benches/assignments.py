#!/usr/bin/env python3
"""Times bmod, and GAMS where there is one, on the texts of benches/models that assign and read data.

usage: benches/assignments.py target/release/bmod [GAMS]

Each text runs with its operation carried out once and six times: the difference, by five, is the operation.
The least of three runs counts.
"""
import os, subprocess, sys, tempfile, time

MODELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "models")
CASES = [
    ("sparse_product.blk", "good"), ("sparse_product.blk", "bad"),
    ("sums.blk", "rows"), ("sums.blk", "columns"), ("sums.blk", "all"),
    ("sums.blk", "loop"), ("sums.blk", "transpose"), ("sums.blk", "insert"),
    ("join.blk", "good"), ("join.blk", "bad"),
    *(("conditions.blk", form) for form in "either sum rest lag most largest diagonal together loop".split()),
    ("scalar_loop.blk", None), ("labels.blk", None),
]


def least(command):
    best = float("inf")
    for _ in range(3):
        start = time.perf_counter()
        done = subprocess.run(command, capture_output=True, cwd=SCRATCH)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: {done.stderr.decode()}")
        best = min(best, time.perf_counter() - start)
        if best > 5:
            break
    return best


def bmod(file, defines):
    options = [x for d in defines for x in ("-D", d)]
    return least([BMOD, "run", file, "--quiet", *options])


def gams(file, defines):
    return least([GAMS, file, "lo=0", "o=" + os.devnull, *["--" + d for d in defines]])


def row(name, form, tools):
    form_of = [f"form={form}"] if form else []
    file = os.path.join(MODELS, name)
    whole, operation = [], []
    for tool in tools:
        once, often = (tool(file, form_of + [f"times={n}"]) for n in (1, 6))
        whole.append(once)
        operation.append(max(often - once, 0) / 5)
    show = lambda times: " ".join(f"{t:8.3f}" for t in times)
    ratio = f"{whole[0] / whole[1]:6.2f}" if len(whole) > 1 else ""
    print(f"{name:20} {form or '':10} whole {show(whole)} {ratio}   operation {show(operation)}", flush=True)


if len(sys.argv) < 2:
    sys.exit(__doc__)
BMOD = os.path.abspath(sys.argv[1])
GAMS = sys.argv[2] if len(sys.argv) > 2 else None
TOOLS = [bmod, gams] if GAMS else [bmod]
with tempfile.TemporaryDirectory() as SCRATCH:
    for name, form in CASES:
        row(name, form, TOOLS)
    data = os.path.join(SCRATCH, "data.gms")
    with open(data, "w") as out:
        subprocess.run(["sh", os.path.join(MODELS, "..", "make_data.sh")], stdout=out, check=True)
    size = os.path.getsize(data) / 1e6
    print(f"{size:.0f} MB of data", " ".join(f"{t(data, []):8.3f}" for t in TOOLS))
