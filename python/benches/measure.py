"""What Python costs: import, a solve, data in and out, solves in a loop, a model beside other packages.

    pip install '.[test]' gamspy pyomo highspy linopy    # the last four for the last table
    python python/benches/measure.py [import solve data loop transport sweep]

Times are processor time (seconds), medians of interleaved runs.
"""

import statistics
import subprocess
import sys
import time

SHOP = """
Set i / a, b /;  Parameter price(i) / a 3, b 5 /;  Scalar room / 6 /;
Positive variable x(i);  Variable z;
Equations value, most(i), total;
value..  z =e= sum(i, price(i)*x(i));
most(i)..  x(i) =l= 4;
total..  sum(i, x(i)) =l= room;
Model shop / all /;  solve shop using lp maximizing z;
"""

TRANSPORT = """
Sets i, j;  Parameters a(i), b(j), c(i,j);
Positive variable x(i,j);  Variable z;
Equations cost, supply(i), demand(j);
cost..      z =e= sum((i,j), c(i,j)*x(i,j));
supply(i).. sum(j, x(i,j)) =l= a(i);
demand(j).. sum(i, x(i,j)) =g= b(j);
Model transport / all /;
solve transport using lp minimizing z;
"""


def median(work, times=5):
    """Median processor time of `work`, all threads."""
    taken = []
    for _ in range(times):
        start = time.process_time()
        work()
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def row(name, value, unit="s"):
    print(f"{name:<64}{value:10.4g} {unit}", flush=True)


def measure_import():
    def fresh(code):
        def work():
            out = subprocess.run(
                [sys.executable, "-c", f"import time; s = time.process_time(); {code}; print(time.process_time() - s)"],
                capture_output=True, text=True, check=True,
            )
            times.append(float(out.stdout))
        times = []
        for _ in range(9):
            work()
        return statistics.median(times)

    row("import bmod", fresh("import bmod"))
    row("import pandas", fresh("import pandas"))


def measure_solve():
    import bmod

    m = bmod.Model.from_text(SHOP)
    m.run()
    rounds = 300

    def from_python():
        for _ in range(rounds):
            m.run()

    def inside():
        for _ in range(rounds):
            m._model.run([], None, None, False, False, None, None)

    both = [(median(from_python, 1), median(inside, 1)) for _ in range(5)]
    row("a run of two variables from Python", statistics.median(b[0] for b in both) / rounds * 1e3, "ms")
    row("the same without what Python does around it", statistics.median(b[1] for b in both) / rounds * 1e3, "ms")


def measure_data():
    import numpy as np
    import pandas as pd

    import bmod

    n = 1000
    m = bmod.Model.from_text(f"set i / i1*i{n} /, j / j1*j{n} /; parameter p(i,j); scalar s; s = sum((i,j), p(i,j));")
    values = np.random.default_rng(1).random((n, n))
    index = pd.MultiIndex.from_product([[f"i{k + 1}" for k in range(n)], [f"j{k + 1}" for k in range(n)]], names=["i", "j"])
    series = pd.Series(values.ravel(), index=index)
    given = {"array": values, "Series": series, "DataFrame": series.unstack()}
    for name, data in given.items():
        row(f"10^6 records in, {name}", median(lambda d=data: m.__setitem__("p", d), 3))
    result = m.run()
    assert abs(result["s"] - values.sum()) < 1e-6 * values.sum()
    row("10^6 records out", median(lambda: result["p"], 5))
    row("the run between (with the text compiled anew)", median(lambda: (m.define("again", time.time()), m.run()), 3))


def measure_loop():
    """A model with 1000 right-hand sides, one after the other."""
    import numpy as np

    import bmod

    size, times = 40, 200
    rng = np.random.default_rng(2)
    names_i, names_j = [f"i{k}" for k in range(size)], [f"j{k}" for k in range(size)]
    data = {"i": names_i, "j": names_j, "a": np.full(size, 12.0), "b": rng.uniform(5, 10, size), "c": rng.uniform(1, 9, (size, size))}
    shifts = rng.uniform(0.95, 1.05, (times, size))
    base = data["b"].copy()

    def loop(model):
        count = 0
        for shift in shifts:
            model["b"] = base * shift
            r = model.run()
            count += r.solves[0].iterations
        return count

    kept = bmod.Model.from_text(TRANSPORT, data=data)
    fresh = bmod.Model.from_text(TRANSPORT, data=data)
    fresh._model.keep(False)
    for name, model in (("kept", kept), ("each from the start", fresh)):
        start = time.process_time()
        count = loop(model)
        taken = time.process_time() - start
        row(f"{times} solves of a {size} x {size} transport, {name}", taken / times * 1e3, f"ms each, {count / times:.0f} iterations")


def transport_data(n):
    import numpy as np

    rng = np.random.default_rng(3)
    b = rng.uniform(10, 20, n)
    return [f"i{k}" for k in range(n)], [f"j{k}" for k in range(n)], np.full(n, 1.2 * b.sum() / n), b, rng.uniform(1, 9, (n, n))


def by_bmod(i, j, a, b, c):
    import bmod

    m = bmod.Model.from_text(TRANSPORT, data={"i": i, "j": j, "a": a, "b": b, "c": c})
    return m.run().objective


def by_linopy(i, j, a, b, c):
    import linopy
    import pandas as pd
    import xarray as xr

    m = linopy.Model()
    si, sj = pd.Index(i, name="i"), pd.Index(j, name="j")
    x = m.add_variables(lower=0, coords=[si, sj], name="x")
    m.add_constraints(x.sum("j") <= xr.DataArray(a, [si]))
    m.add_constraints(x.sum("i") >= xr.DataArray(b, [sj]))
    m.add_objective((x * xr.DataArray(c, [si, sj])).sum())
    m.solve(solver_name="highs", io_api="direct", output_flag=False)
    return float(m.objective.value)


def by_pyomo(i, j, a, b, c):
    import pyomo.environ as pyo

    m = pyo.ConcreteModel()
    m.x = pyo.Var(range(len(i)), range(len(j)), domain=pyo.NonNegativeReals)
    m.z = pyo.Objective(expr=sum(c[p, q] * m.x[p, q] for p in range(len(i)) for q in range(len(j))))
    m.supply = pyo.Constraint(range(len(i)), rule=lambda m, p: sum(m.x[p, q] for q in range(len(j))) <= a[p])
    m.demand = pyo.Constraint(range(len(j)), rule=lambda m, q: sum(m.x[p, q] for p in range(len(i))) >= b[q])
    pyo.SolverFactory("appsi_highs").solve(m)
    return pyo.value(m.z)


def by_gamspy(i, j, a, b, c):
    import gamspy as gp

    m = gp.Container()
    si, sj = gp.Set(m, "i", records=i), gp.Set(m, "j", records=j)
    pa, pb = gp.Parameter(m, "a", si, records=a), gp.Parameter(m, "b", sj, records=b)
    pc = gp.Parameter(m, "c", [si, sj], records=c)
    x = gp.Variable(m, "x", "positive", domain=[si, sj])
    supply, demand = gp.Equation(m, "supply", domain=si), gp.Equation(m, "demand", domain=sj)
    supply[si] = gp.Sum(sj, x[si, sj]) <= pa[si]
    demand[sj] = gp.Sum(si, x[si, sj]) >= pb[sj]
    model = gp.Model(m, "transport", equations=[supply, demand], problem="LP", sense=gp.Sense.MIN,
                     objective=gp.Sum((si, sj), pc[si, sj] * x[si, sj]))
    model.solve()
    return model.objective_value


def measure_transport(n=300):
    """Building and solving, all processes: gamspy's size-limited GAMS takes 40 x 40 and not 300 x 300."""
    import importlib.util
    import os

    def installed(package):
        found = importlib.util.find_spec(package) is not None
        print("" if found else f"{package} is not installed\n", end="")
        return found

    for size, ways in ((n, (by_bmod, by_linopy, by_pyomo)), (40, (by_bmod, by_gamspy))):
        data = transport_data(size)
        ways = [way for way in ways if installed(way.__name__[3:])]
        values, taken = {}, {way: [] for way in ways}
        for turn in range(6):  # in turn, so that a busy machine is busy for all; the first imports
            for way in ways:
                before = os.times()
                values[way] = way(*data)
                after = os.times()
                if turn > 0:
                    taken[way].append(sum(after[:4]) - sum(before[:4]))
        for way in ways:
            row(f"transport {size} x {size}, build and solve, {way.__name__[3:]}", statistics.median(taken[way]))
        assert max(values.values()) - min(values.values()) < 1e-6 * max(values.values()), values


def measure_sweep(path="models/wall.blk"):
    """1000 variants of the wall: on one process and on two."""
    import numpy as np

    import bmod

    grid = {"friction": [round(f, 4) for f in np.linspace(0.3, 0.9, 1000)]}
    for jobs in (1, 2):
        start = time.perf_counter()
        table = bmod.sweep(path, grid, outputs=["alpha"], jobs=jobs, progress=False)
        assert list(table.run) == ["ok"] * 1000
        row(f"1000 walls on {jobs} process{'es' if jobs > 1 else ''}, elapsed", time.perf_counter() - start)


if __name__ == "__main__":
    wanted = sys.argv[1:] or ["import", "solve", "data", "loop", "transport"]
    for what in wanted:
        globals()[f"measure_{what}"]()
