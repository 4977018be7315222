"""End to end: bmod (whole process) beside CasADi and its Ipopt (building and solving, start of Python left out).

    pip install casadi && cargo build --release --features ipopt
    python3 benches/ipopt.py [BINARY]

Medians of three runs; one start for all, that of the model's file, and one tolerance: CasADi's default leaves thrust at
1e-5 off its bounds. `search`: the default, which looks for better local
optima where that is cheap.
"""
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import casadi as ca

ROOT = Path(__file__).resolve().parent.parent
BMOD = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/bmod")
RUNS = 3


def chain(n):
    x = ca.SX.sym("x", n)
    f = sum(100 * (x[i + 1] - x[i] ** 2) ** 2 + (1 - x[i]) ** 2 for i in range(n - 1))
    start = [1 - 2.2 * ((i + 1) % 2) for i in range(n)]
    inf = [ca.inf] * n
    return x, f, ca.SX(0, 1), [-v for v in inf], inf, start


def rocket(n, own=True):
    """models/teaching/rocket.blk; without `own` variables for drag and gravity benches/models/rocket.blk."""
    names = ["h", "v", "m", "thrust"]
    k = n + 1
    s = {a: ca.SX.sym(a, k) for a in names}
    dt = ca.SX.sym("dt")
    h, v, m, thrust = (s[a] for a in names)
    c, mf, dc, tmax = 0.5, 0.6, 310.0, 3.5
    drag, gravity = dc * v**2 * ca.exp(-500 * (h - 1)), (1 / h) ** 2
    part = [i / n for i in range(k)]
    low = [1.0] * k + [0.0] * k + [mf] * k + [0.0] * k + [0.0]
    up = [ca.inf] * (2 * k) + [1.0] * k + [tmax] * k + [ca.inf]
    start = [1.0] * k + [p * (1 - p) for p in part] + [1 + (mf - 1) * p for p in part] + [tmax / 2] * k + [1 / n]
    definitions, x = [], [h, v, m, thrust, dt]
    if own:
        d, g = ca.SX.sym("drag", k), ca.SX.sym("gravity", k)
        definitions, x = [d - drag, g - gravity], x + [d, g]
        drag, gravity = d, g
        low += [-ca.inf] * (2 * k)
        up += [ca.inf] * (2 * k)
        start += [dc * (p * (1 - p)) ** 2 for p in part] + [1.0] * k
    force = (thrust - drag) / m - gravity
    both = lambda e: e[1:] + e[:-1]
    step = lambda e: e[1:] - e[:-1]
    g = ca.vertcat(
        step(h) - 0.5 * dt * both(v),
        step(v) - 0.5 * dt * both(force),
        step(m) + 0.5 * dt * both(thrust) / c,
        *definitions,
    )
    for at, value in [(0, 1.0), (k, 0.0), (2 * k, 1.0), (3 * k - 1, mf)]:
        low[at] = up[at] = value
    return ca.vertcat(*x), -h[-1], g, low, up, start


def casadi(build, n):
    begin = time.perf_counter()
    x, f, g, low, up, start = build(n)
    quiet = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-9, "ipopt.compl_inf_tol": 1e-12}
    solver = ca.nlpsol("solver", "ipopt", {"x": x, "f": f, "g": g}, quiet)
    built = time.perf_counter()
    result = solver(x0=start, lbx=low, ubx=up, lbg=0, ubg=0)
    end = time.perf_counter()
    stats = solver.stats()
    return end - begin, built - begin, float(result["f"]), stats["iter_count"], stats["return_status"]


def bmod(model, n, solver, search):
    command = [BMOD, "run", "--quiet", "--json", "-", "--out", "/tmp", "-D", f"n={n}", "--option", f"nlp={solver}", "--option", f"nlp_search={search}"]
    begin = time.perf_counter()
    done = subprocess.run(command + [str(ROOT / model)], capture_output=True, check=False)
    end = time.perf_counter()
    s = json.loads(done.stdout)["solves"][0]
    return end - begin, s["seconds"]["generate"], s["objective"], s["iterations"], s["model_status"]["name"]


def row(name, n, who, run):
    runs = [run() for _ in range(RUNS)]
    total, setup = (statistics.median(r[k] for r in runs) for k in (0, 1))
    _, _, objective, iterations, status = runs[0]
    print(f"| {name} | {n} | {who} | {total:.3f} | {setup:.3f} | {iterations} | {abs(objective):.9g} | {status} |", flush=True)


print("| model | n | solver | seconds | of these, set-up | iterations | objective | status |")
print("| --- | --: | --- | --: | --: | --: | --: | --- |")
for name, model, build, sizes in [
    ("rocket", "models/teaching/rocket.blk", rocket, (50, 200, 800)),
    ("rocket, expressions", "benches/models/rocket.blk", lambda n: rocket(n, False), (50, 200, 800)),
    ("chain", "benches/models/chain.blk", chain, (100, 1000)),
]:
    for n in sizes:
        row(name, n, "CasADi + Ipopt", lambda: casadi(build, n))
        for solver, search in [("ipopt", "no"), ("pounce", "no"), ("pounce", "yes")]:
            note = ", search" if search == "yes" else ""
            row(name, n, f"bmod + {solver}{note}", lambda: bmod(model, n, solver, search))
