#!/usr/bin/env python3
"""Times bmod, and GAMS where there is one, reading data of several shapes, 20 to 50 MB each.

usage: benches/reading.py target/release/bmod [GAMS] [SHAPE…]

Processor seconds, medians of five runs in turn: the clock depends on what else the machine does.
"""
import os, random, resource, statistics, subprocess, sys, tempfile

random.seed(1)
number = lambda: f"{random.uniform(0, 100):.4f}"
PAIRS = "set i / i1*i2000 /, j / j1*j1500 /;\n"


def pairs(record, columns):
    return (record(f"i{a}", f"j{b}") for a in range(1, 2001) for b in range(1, columns + 1))


def rows(cell, between, label):
    lines = (label(f"r{a}") + between.join(cell() for _ in range(5)) for a in range(1, 800_001))
    return "\n".join(lines)


def parameter(records, before="", after=""):
    return PAIRS + before + "parameter p(i,j) /\n" + "\n".join(records) + "\n/;\n" + after


def narrow(heading, between, cell, label, before="", after=""):
    sets = "set k / k1*k5 /, r / r1*r800000 /;\n"
    return sets + before + f"table t(r,k)\n{heading}\n" + rows(cell, between, label) + "\n;\n" + after


DELIM = ("$onDelim\n", "$offDelim\n")
SHAPES = {
    "list": lambda: parameter(pairs(lambda a, b: f"{a}.{b} {number()}", 1000)),
    "quoted": lambda: parameter(pairs(lambda a, b: f"'{a}'.'{b}' {number()}", 900)),
    "blanks": lambda: parameter(pairs(lambda a, b: f"{a} . {b}     {number()}", 1000)),
    "delimited": lambda: parameter(pairs(lambda a, b: f"{a},{b},{number()}", 1000), *DELIM),
    "tuples": lambda: PAIRS + "set m(i,j) /\n" + "\n".join(pairs(lambda a, b: f"{a}.{b}", 1400)) + "/;\n",
    "labels": lambda: "set l /\n" + "\n".join(f"label_{a * 7919 % 1500007}" for a in range(1, 1_500_001)) + "/;\n",
    "table": lambda: narrow(" " * 12 + "".join(f"{k:<10}" for k in "k1 k2 k3 k4 k5".split()), "",
                            lambda: f"{number():<10}", lambda r: f"{r:<12}"),
    "table, delimited": lambda: narrow("r,k1,k2,k3,k4,k5", ",", number, lambda r: r + ",", *DELIM),
}


def seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, cwd=SCRATCH)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: {done.stderr.decode()}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if len(sys.argv) < 2:
    sys.exit(__doc__)
BMOD = os.path.abspath(sys.argv[1])
GAMS = sys.argv[2] if len(sys.argv) > 2 else None
with tempfile.TemporaryDirectory() as SCRATCH:
    for name in sys.argv[3:] or SHAPES:
        file = os.path.join(SCRATCH, "data.gms")
        with open(file, "w") as out:
            out.write(SHAPES[name]())
        size = os.path.getsize(file) / 1e6
        commands = [[BMOD, "run", file, "--quiet"]]
        if GAMS:
            commands.append([GAMS, file, "lo=0", "o=" + os.devnull])
        runs = [[seconds(command) for command in commands] for _ in range(5)]
        mine, *theirs = (statistics.median(times) for times in zip(*runs))
        line = f"{name:18} {size:5.1f} MB   bmod {mine:6.3f}"
        for gams in theirs:
            line += f"   GAMS {gams:6.3f}   ratio {mine / gams:5.3f}"
        print(line, flush=True)
