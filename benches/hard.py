"""Time and error of every model of models/hard at each accuracy setting, for docs/lab/accuracy.md.

    python3 benches/hard.py BMOD [SKIP...]

BMOD is the program; files whose name contains one of SKIP are left out. Errors are against the proved interval.
"""
import json
import pathlib
import subprocess
import sys


def run(program, path, *options):
    command = [program, "run", str(path), "--json", "-", "--out", "/tmp", "--time-limit", "100", *options]
    done = subprocess.run(command, capture_output=True, text=True)
    return json.loads(done.stdout)["solves"][-1]


def main():
    program, skip = sys.argv[1], sys.argv[2:]
    print("| model | type | status | objective | width | fast | standard | high |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for path in sorted(pathlib.Path("models/hard").glob("*.blk")):
        if any(s in path.name for s in skip):
            continue
        best = run(program, path, "--certify")
        bounds = [b for b in best.get("bounds", []) if isinstance(b, float)]
        proved = len(bounds) == 2
        middle = sum(bounds) / 2 if proved else None
        cells = []
        for accuracy in ["fast", "standard", "high"]:
            if best["using"] != "lp":
                cells.append(f"{best['seconds']['solve']:.3f} s" if accuracy == "standard" else "")
                continue
            s = run(program, path, "--option", f"lp_accuracy={accuracy}")
            text = f"{s['seconds']['solve']:.3f} s"
            if proved:
                text += f", {abs(s['objective'] - middle) / max(abs(middle), 1e-9):.0e}"
            cells.append(text)
        value = best["objective"]
        solved = best["model_status"]["code"] in (1, 2)
        shown = f"{value:.10g}" if solved and value is not None else ""
        width = f"{bounds[1] - bounds[0]:.0e}" if proved else ""
        print(f"| {path.stem} | {best['using']} | {best['model_status']['name']} | {shown} | {width} | " + " | ".join(cells) + " |")


main()
