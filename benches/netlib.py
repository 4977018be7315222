"""The linear programs of Netlib, for docs/lab/accuracy.md.

    python3 benches/netlib.py [--times] BMOD FOLDER [NAME...]

FOLDER is `benchmarks/benchmarks/linprog_benchmark_files` of SciPy's source distribution, which has the programs as arrays; numpy and
scipy read them. `TMPDIR=$PWD pip download --no-deps --no-binary :all: --no-clean scipy` leaves it in pip-download-*/scipy_*, whether or not
pip can go on from there. Each is written as a model, solved by bmod with
--certify and by HiGHS (through SciPy), and printed where the two disagree; the programs of the subfolder `infeasible` have to
be called so. A run may take 100 s. --times: without --certify and without the infeasible ones; processor time of the whole process of bmod, which
reads the text, beside that of the call of HiGHS; ratios with a floor of 20 ms, of the programs that HiGHS ends in its 100 s.
"""
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import warnings

import numpy
from scipy.optimize import linprog
from scipy.sparse import coo_matrix

warnings.filterwarnings("ignore")
SECONDS = 100
FLOOR = 0.02


def arrays(path):
    """c, (A, b) of the inequalities, (A, b) of the equations, bounds as pairs."""
    data = numpy.load(path, allow_pickle=True)
    cost = data["c"].ravel()

    def rows(matrix, side):
        a = data[matrix]
        a = a.item() if a.dtype == object else a
        return None if a is None or not numpy.size(a) else (coo_matrix(a), numpy.atleast_1d(data[side]).ravel())

    bounds = numpy.asarray(data["bounds"])
    bounds = bounds.reshape(-1, 2) if bounds.size else [(0, None)] * len(cost)

    def side(v, infinite):
        return infinite if v is None or numpy.isnan(float(v)) else float(v)

    bounds = [(side(l, -numpy.inf), side(u, numpy.inf)) for l, u in bounds]
    return cost, rows("A_ub", "b_ub"), rows("A_eq", "b_eq"), bounds


def spelled(v):
    # eps is a zero that counts as data
    return {numpy.inf: "inf", -numpy.inf: "-inf", 0: "eps"}.get(v, repr(float(v)))


def parameter(name, domain, records):
    lines = "\n".join(f"{key} {spelled(v)}" for key, v in records)
    return f"parameter {name}({domain}) /\n{lines}\n/;\n" if lines else f"parameter {name}({domain}); {name}({domain}) = 0;\n"


def model(cost, inequalities, equations, bounds):
    text = [f"set j / 1*{len(cost)} /;\n"]
    text.append(parameter("c", "j", [(j + 1, v) for j, v in enumerate(cost) if v]))
    text.append("variable x(j), z; equation goal; goal.. z =e= sum(j, c(j)*x(j));\n")
    for name, relation, rows in (("le", "=l=", inequalities), ("eq", "=e=", equations)):
        if rows is None:
            continue
        a, b = rows
        text.append(f"set {name} / 1*{a.shape[0]} /;\n")
        entries = ((f"{i + 1}.{j + 1}", v) for i, j, v in zip(a.row, a.col, a.data) if v)
        text.append(parameter(f"a{name}", f"{name},j", entries))
        text.append(parameter(f"b{name}", name, [(i + 1, v) for i, v in enumerate(b) if v]))
        text.append(f"equation r{name}({name}); r{name}({name}).. sum(j, a{name}({name},j)*x(j)) {relation} b{name}({name});\n")
    text.append(parameter("lo", "j", [(j + 1, l) for j, (l, _) in enumerate(bounds) if l]))
    text.append("x.lo(j) = lo(j);\n")
    text.append(parameter("up", "j", [(j + 1, u) for j, (_, u) in enumerate(bounds) if numpy.isfinite(u)]))
    text.append("x.up(j)$up(j) = up(j);\n")
    text.append("model m / all /; solve m using lp minimizing z;\n")
    return "".join(text)


def highs(cost, inequalities, equations, bounds):
    (a, b), (e, f) = inequalities or (None, None), equations or (None, None)
    options = {"time_limit": SECONDS}
    return linprog(cost, a, b, e, f, bounds, method="highs", options=options)


def children():
    """Processor seconds of all processes that have ended; os.times counts in hundredths."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    times = "--times" in sys.argv
    program, folder, *names = [a for a in sys.argv[1:] if a != "--times"]
    folder = pathlib.Path(folder)
    files = sorted(folder.glob("*.npz")) + ([] if times else sorted(folder.glob("infeasible/*.npz")))
    count, proved, mine, theirs, ratios = 0, 0, 0.0, 0.0, []
    for path in files:
        if path.stem.startswith("milp") or names and path.stem not in names:
            continue
        count += 1
        data = arrays(path)
        with tempfile.TemporaryDirectory() as place:
            file = pathlib.Path(place) / "m.blk"
            file.write_text(model(*data))
            command = [program, "run", str(file), "--json", "-", "--out", place, "--time-limit", str(SECONDS)]
            before = children()
            done = subprocess.run([*command, *([] if times else ["--certify"])], capture_output=True, text=True)
            seconds = children() - before
        solve = json.loads(done.stdout)["solves"][-1]
        status, objective = solve["model_status"]["name"], solve.get("objective")
        before = time.process_time()
        other = highs(*data)
        other_seconds = time.process_time() - before
        right = status == {0: "optimal", 2: "infeasible"}.get(other.status)
        error = abs(objective - other.fun) / max(1, abs(other.fun)) if right and other.status == 0 else 0.0
        bounds = solve.get("bounds")
        proved += bounds is not None and all(isinstance(b, float) for b in bounds)
        if not times or other.status == 0:
            mine, theirs = mine + seconds, theirs + other_seconds
            ratios.append((max(seconds, FLOOR) / max(other_seconds, FLOOR), path.stem))
        remark = "" if right and error < 1e-8 else "   <--"
        print(
            f"{path.stem:12} {status:12} {objective} error {error:.1e} interval {bounds} {seconds:.2f} s"
            f" | HiGHS {other.status} {other.fun} {other_seconds:.2f} s{remark}",
            flush=True,
        )
    if times:
        mean = math.exp(sum(math.log(r) for r, _ in ratios) / len(ratios))
        worst = ", ".join(f"{name} {r:.1f}" for r, name in sorted(ratios, reverse=True)[:10])
        print(f"{len(ratios)} of {count} programs that HiGHS ends: {mine:.1f} s, HiGHS {theirs:.1f} s; ratios: mean {mean:.2f}, worst {worst}")
    else:
        print(f"{count} programs, {proved} with a proved interval; {mine:.1f} s with the proofs, HiGHS {theirs:.1f} s without")


if __name__ == "__main__":
    main()
