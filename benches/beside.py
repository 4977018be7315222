"""Clarabel alone, HiGHS and Ipopt on the models of models/hard, for docs/lab/accuracy.md (pip install highspy casadi).

    python3 benches/beside.py BMOD [SKIP...]

The linear programs are bmod's own (its --solution); errors are against the middle of its proved interval. Each solver has its
own defaults: HiGHS and Ipopt those of highspy and CasADi, one thread; Clarabel is `--option method=interior`. The nonlinear programs are
written again for CasADi, with the starts of the models. A time is that of the call, one run.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import casadi as ca
import highspy
import numpy as np

from highs import load

FOLDER = pathlib.Path("models/hard")


def bmod(program, path, *options):
    """The report of the last solve."""
    command = [program, "run", str(path), "--json", "-", "--out", tempfile.gettempdir(), "--time-limit", "100", *options]
    done = subprocess.run(command, capture_output=True, text=True)
    return json.loads(done.stdout)["solves"][-1]


def timed(call):
    begin = time.perf_counter()
    result = call()
    return result, time.perf_counter() - begin


def by_highs(lp):
    h = highspy.Highs()
    for k, v in [("output_flag", False), ("threads", 1), ("time_limit", 100.0)]:
        h.setOptionValue(k, v)
    h.passModel(lp)
    _, seconds = timed(h.run)
    return h.modelStatusToString(h.getModelStatus()), h.getInfo().objective_function_value, seconds


def by_ipopt(problem, **given):
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_wall_time": 100.0}
    solver = ca.nlpsol("s", "ipopt", problem, quiet)
    try:
        result, seconds = timed(lambda: solver(**given))
    except RuntimeError:
        return "Error", float("nan"), 0.0
    return solver.stats()["return_status"], float(result["f"]), seconds


def linear(lp):
    """The same program for Ipopt, from the origin brought within the bounds."""
    n, m = lp.num_col_, lp.num_row_
    x = ca.MX.sym("x", n)
    a = lp.a_matrix_
    index = [int(i) for i in a.index_]
    matrix = ca.DM(ca.Sparsity(m, n, [int(s) for s in a.start_], index), list(a.value_))
    sign = -1.0 if lp.sense_ == highspy.ObjSense.kMaximize else 1.0
    cost = ca.DM(np.array(lp.col_cost_))
    start = np.clip(np.zeros(n), lp.col_lower_, lp.col_upper_)
    status, value, seconds = by_ipopt(
        {"x": x, "f": sign * ca.dot(cost, x), "g": ca.mtimes(matrix, x)},
        x0=start, lbx=lp.col_lower_, ubx=lp.col_upper_, lbg=lp.row_lower_, ubg=lp.row_upper_,
    )
    return status, sign * value, seconds


def nonlinear():
    """Problem, start, bounds of columns and rows, and the optimal value, by the model's name."""
    inf = ca.inf
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    p = ca.SX.sym("p", 4)
    v = ca.vertcat(x, y)
    powell = (p[0] + 10 * p[1]) ** 2 + 5 * (p[2] - p[3]) ** 2 + (p[1] - 2 * p[2]) ** 4 + 10 * (p[0] - p[3]) ** 4
    brown = (x - 1e6) ** 2 + (y - 2e-6) ** 2 + (x * y - 2) ** 2
    discs = ca.vertcat(x**2 + y**2, (x - 2) ** 2 + y**2)
    return {
        "nlp_domain": ({"x": v, "f": x - ca.log(y), "g": x - y}, [0, 0], [-inf, 1e-8], inf, 0, inf, 1.0),
        "nlp_no_interior": ({"x": v, "f": x + y, "g": discs}, [0.5, 0.5], -inf, inf, -inf, 1, 1.0),
        "nlp_scaled": ({"x": v, "f": brown}, [1, 1], -inf, inf, [], [], 0.0),
        "nlp_singular": ({"x": p, "f": powell}, [3, -1, 0, 1], -inf, inf, [], [], 0.0),
    }


def cell(answer, right):
    """Time, and the error (absolute where the value is 0) or what the solver says instead of one."""
    status, value, seconds = answer
    solved = status.lower().startswith(("optimal", "feasible", "locally", "solve"))
    if right is None or not solved:
        return f"{seconds:.3f} s, {status.replace('_', ' ').lower()}"
    return f"{seconds:.3f} s, {abs(value - right) / (abs(right) if abs(right) > 1e-9 else 1.0):.0e}"


def main():
    program, skip = sys.argv[1], sys.argv[2:]
    print("| model | Clarabel | HiGHS | Ipopt |")
    print("| --- | --- | --- | --- |")
    for path in sorted(FOLDER.glob("*.blk")):
        if any(s in path.name for s in skip):
            continue
        file = pathlib.Path(tempfile.gettempdir()) / "beside.json"
        report = bmod(program, path, "--certify", "--solution", str(file))
        if report["using"] != "lp":
            continue
        bounds = [b for b in report.get("bounds", []) if isinstance(b, float)]
        right = sum(bounds) / 2 if len(bounds) == 2 else None
        lp = load(file, -1)
        alone = bmod(program, path, "--option", "method=interior")
        value = alone["objective"] if alone["objective"] is not None else float("nan")
        answer = alone["model_status"]["name"], value, alone["seconds"]["solve"]
        cells = [cell(a, right) for a in (answer, by_highs(lp), linear(lp))]
        print(f"| {path.stem} | {' | '.join(cells)} |", flush=True)
    for model, (problem, start, low, high, row_low, row_high, right) in nonlinear().items():
        if not any(s in model for s in skip):
            answer = by_ipopt(problem, x0=start, lbx=low, ubx=high, lbg=row_low, ubg=row_high)
            print(f"| {model} | | | {cell(answer, right)} |", flush=True)


if __name__ == "__main__":
    main()
