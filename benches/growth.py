"""Time of a linear program against the number of contacts, for docs/lab/accuracy.md.

    python3 benches/growth.py BMOD [N...]

runs walls in running bond of n courses, n full lengths wide, at both settings of lp_accuracy (above LARGEST courses only
`fast`), fits the exponents, and says where the time of the largest wall goes. Seconds are those of the processor (user time
of the whole run, generation included): other programs disturb them less. A phase is a share of the clock: what the log says.
"""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MODEL = """$set n {n}
$include running_bond.inc
solve static using lp maximizing alpha;
"""
# Courses up to which `standard` is run: it takes minutes there.
LARGEST = 80


def run(program, path, accuracy):
    """Seconds of the processor, the report of the solve, and its phases as pairs of name and seconds since the solve began."""
    command = [program, "run", str(path), "--json", "-", "--out", tempfile.gettempdir()]
    for option in [f"lp_accuracy={accuracy}", "log=on", "reslim=3000"]:
        command += ["--option", option]
    before = os.times().children_user
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    seconds = os.times().children_user - before
    phases = re.findall(r"^\s*(scaling|interior point|crossover|simplex|tightened)\b.*?([\d.]+) s$", done.stderr, re.M)
    return seconds, json.loads(done.stdout)["solves"][-1], [(name, float(at)) for name, at in phases]


def exponent(points):
    """Slope of the least-squares line through the logarithms."""
    x, y = [math.log(p[0]) for p in points], [math.log(p[1]) for p in points]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def shares(solve, phases):
    """Shares of the clock."""
    total = solve["seconds"]["total"]
    parts, before = [("generation", solve["seconds"]["generate"])], 0.0
    for name, at in phases:
        parts.append((name, at - before))
        before = at
    return ", ".join(f"{name} {100 * seconds / total:.0f} %" for name, seconds in parts)


def main():
    program, sizes = sys.argv[1], [int(n) for n in sys.argv[2:]] or [7, 10, 14, 20, 28, 40]
    times, last = {"fast": [], "standard": []}, {}
    print("| n | contacts | rows | columns | generation | fast | standard | iterations of standard |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for n in sizes:
        path = pathlib.Path("models/hard") / f"growth_{n}.blk"
        path.write_text(MODEL.format(n=n))
        try:
            results = {a: run(program, path, a) for a in times if a == "fast" or n <= LARGEST}
        finally:
            path.unlink()
        solve = results["fast"][1]
        contacts = (solve["columns"] - 1) // 3
        for a, (seconds, report, phases) in results.items():
            times[a].append((contacts, max(seconds, 1e-3)))
            last[a] = (n, shares(report, phases))
        standard = results.get("standard")
        print(
            f"| {n} | {contacts} | {solve['rows']} | {solve['columns']} | {solve['seconds']['generate']:.3f} s"
            f" | {results['fast'][0]:.2f} s"
            + (f" | {standard[0]:.2f} s | {standard[1]['iterations']} |" if standard else " | | |"),
            flush=True,
        )
    for a, points in times.items():
        if len(points) > 1:
            print(f"{a}: time grows with the {exponent(points):.2f}th power of the number of contacts")
    for a, (n, text) in last.items():
        print(f"{a} at n = {n}: {text}")


if __name__ == "__main__":
    main()
