"""HiGHS beside bmod, for docs/lab/accuracy.md (pip install highspy).

    bmod run models/walls/example6.blk -D lponly=1 --solution s.json --quiet
    python3 benches/highs.py s.json REFERENCE

solves the first linear program of the file by HiGHS at several tolerances and prints, for each, time, objective and
its relative error against the reference (the middle of bmod's proved interval).
"""
import json
import sys
import time

import highspy
import numpy as np


def value(v):
    return {"+INF": highspy.kHighsInf, "-INF": -highspy.kHighsInf}.get(v, v)


def load(path, which=0):
    solve = json.load(open(path))["solves"][which]
    lp = highspy.HighsLp()
    rows, columns = solve["rows"], solve["columns"]
    lp.num_col_, lp.num_row_ = len(columns), len(rows)
    lp.sense_ = highspy.ObjSense.kMaximize if solve["sense"] == "max" else highspy.ObjSense.kMinimize
    cost = np.zeros(len(columns))
    cost[solve["objective"]] = 1.0
    lp.col_cost_ = cost
    lp.col_lower_ = np.array([value(c["lower"]) for c in columns], dtype=float)
    lp.col_upper_ = np.array([value(c["upper"]) for c in columns], dtype=float)
    lp.row_lower_ = np.array([value(r["lower"]) for r in rows], dtype=float)
    lp.row_upper_ = np.array([value(r["upper"]) for r in rows], dtype=float)
    entries = sorted((j, i, a) for i, j, a in solve["coefficients"])
    start = np.zeros(len(columns) + 1, dtype=int)
    for j, _, _ in entries:
        start[j + 1] += 1
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_ = np.cumsum(start)
    lp.a_matrix_.index_ = np.array([e[1] for e in entries])
    lp.a_matrix_.value_ = np.array([e[2] for e in entries])
    return lp


def main():
    lp, reference = load(sys.argv[1]), float(sys.argv[2])
    print("| solver | tolerance | status | seconds | error | objective |")
    print("|---|---|---|---|---|---|")
    for solver, crossover in [("simplex", "on"), ("ipm", "off"), ("ipm", "on")]:
        for tolerance in [1e-7, 1e-10]:
            h = highspy.Highs()
            for k, v in [
                ("output_flag", False), ("threads", 1), ("time_limit", 120.0), ("solver", solver),
                ("run_crossover", crossover), ("primal_feasibility_tolerance", tolerance),
                ("dual_feasibility_tolerance", tolerance), ("ipm_optimality_tolerance", tolerance),
            ]:
                h.setOptionValue(k, v)
            h.passModel(lp)
            begin = time.perf_counter()
            h.run()
            seconds = time.perf_counter() - begin
            v = h.getInfo().objective_function_value
            name = "HiGHS " + solver + (" and crossover" if solver == "ipm" and crossover == "on" else "")
            status = h.modelStatusToString(h.getModelStatus())
            error = abs(v - reference) / abs(reference)
            print(f"| {name} | {tolerance:.0e} | {status} | {seconds:.3f} | {error:.1e} | {v:.12f} |")


if __name__ == "__main__":
    main()
