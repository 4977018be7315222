"""Time of a linear program against the number of contacts, for docs/accuracy.md.

    python3 benches/growth.py BMOD [N...]

runs walls in running bond of n courses, n full lengths wide, at both settings of lp_accuracy, and fits the exponents. Seconds
are those of the processor (user time of the whole run, generation included): other programs do not disturb them.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

MODEL = """$set n {n}
$include running_bond.inc
solve static using lp maximizing alpha;
"""


def run(program, path, accuracy):
    command = [program, "run", str(path), "--json", "-", "--out", tempfile.gettempdir(), "--option", f"lp_accuracy={accuracy}"]
    before = os.times().children_user
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return os.times().children_user - before, json.loads(done.stdout)["solves"][-1]


def exponent(points):
    """Slope of the least-squares line through the logarithms."""
    x, y = [math.log(p[0]) for p in points], [math.log(p[1]) for p in points]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def main():
    program, sizes = sys.argv[1], [int(n) for n in sys.argv[2:]] or [7, 10, 14, 20, 28, 40]
    times = {"fast": [], "standard": []}
    print("| n | contacts | rows | columns | generation | fast | standard | iterations of standard |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for n in sizes:
        path = pathlib.Path("models/hard") / f"growth_{n}.blk"
        path.write_text(MODEL.format(n=n))
        try:
            results = {a: run(program, path, a) for a in times}
        finally:
            path.unlink()
        solve = results["standard"][1]
        contacts = (solve["columns"] - 1) // 3
        for a, (seconds, _) in results.items():
            times[a].append((contacts, max(seconds, 1e-3)))
        print(
            f"| {n} | {contacts} | {solve['rows']} | {solve['columns']} | {solve['seconds']['generate']:.3f} s"
            f" | {results['fast'][0]:.2f} s | {results['standard'][0]:.2f} s | {solve['iterations']} |",
            flush=True,
        )
    for a, points in times.items():
        print(f"{a}: time grows with the {exponent(points):.2f}th power of the number of contacts")


if __name__ == "__main__":
    main()
