"""Made programs with integers, solved by bmod and by HiGHS on the same numbers.

    python3 -m venv v && v/bin/pip install highspy
    v/bin/python benches/integers.py target/release/bmod [--limit 60] [--only cover] [--solver bmip,highs]

Writes every program as GAMS text and as MPS into a temporary folder, runs `bmod run` with each solver named (`highs` is
there with the cargo feature of that name) and highspy with one thread, both to optCR = 1e-4, and prints seconds of
processor time, nodes, and values: of bmod the whole process, of highspy what reading and solving take.
"""
import argparse, json, os, random, resource, subprocess, sys, tempfile

import integer_kinds


def cover(n):
    m = n // 4
    cost = [random.randint(1, 100) for _ in range(n)]
    rows = [([(j, 1) for j in random.sample(range(n), max(2, n // 25))], "G", 1) for _ in range(m)]
    return cost, rows, [1] * n, n


def knapsack(n):
    m = max(2, n // 6)
    w = [[random.randint(5, 100) for _ in range(n)] for _ in range(m)]
    cost = [-(sum(w[i][j] for i in range(m)) // m + random.randint(0, 40)) for j in range(n)]
    rows = [(list(enumerate(w[i])), "L", sum(w[i]) // 2) for i in range(m)]
    return cost, rows, [1] * n, n


def assignment(n):
    m = max(3, n // 5)
    x = lambda i, j: i * n + j
    a = [[random.randint(5, 25) for _ in range(n)] for _ in range(m)]
    cost = [random.randint(10, 50) for _ in range(m * n)]
    rows = [([(x(i, j), 1) for i in range(m)], "E", 1) for j in range(n)]
    rows += [([(x(i, j), a[i][j]) for j in range(n)], "L", int(0.8 * sum(a[i]) / m)) for i in range(m)]
    return cost, rows, [1] * (m * n), m * n


def lots(n):
    """n periods, n/4 items: x, stock, setup; a common capacity."""
    items = max(2, n // 4)
    x, s, y = (lambda i, t: i * n + t), (lambda i, t: (items + i) * n + t), (lambda i, t: (2 * items + i) * n + t)
    d = [[random.randint(0, 60) for _ in range(n)] for _ in range(items)]
    size = items * n
    # the setups are the integers and come first below
    cost = [0] * size + [1 + i % 3 for i in range(items) for _ in range(n)] + [random.randint(80, 200) for _ in range(size)]
    rows = []
    for i in range(items):
        for t in range(n):
            before = [(s(i, t - 1), 1)] if t else []
            rows.append((before + [(x(i, t), 1), (s(i, t), -1)], "E", d[i][t]))
            rows.append(([(x(i, t), 1), (y(i, t), -sum(d[i][t:]) or -1)], "L", 0))
    for t in range(n):
        rows.append(([(x(i, t), 1) for i in range(items)], "L", 45 * items + 60))
    upper = [1e5] * (2 * size) + [1] * size
    order = list(range(2 * size, 3 * size)) + list(range(2 * size))
    place = {j: k for k, j in enumerate(order)}
    rows = [([(place[j], v) for j, v in terms], sense, b) for terms, sense, b in rows]
    return [cost[j] for j in order], rows, [upper[j] for j in order], size


def bins(n):
    m = n // 2
    size = [random.randint(20, 60) for _ in range(n)]
    x = lambda i, b: m + i * m + b
    cost = [1] * m + [0] * (n * m)
    rows = [([(x(i, b), 1) for b in range(m)], "E", 1) for i in range(n)]
    rows += [([(x(i, b), size[i]) for i in range(n)] + [(b, -100)], "L", 0) for b in range(m)]
    rows += [([(b, 1), (b + 1, -1)], "G", 0) for b in range(m - 1)]
    return cost, rows, [1] * (m + n * m), m + n * m


FAMILIES = {
    "cover": (cover, [60, 200, 500, 1000]),
    "knapsack": (knapsack, [15, 30, 60]),
    "assignment": (assignment, [15, 25, 40, 60]),
    "lots": (lots, [8, 12, 20, 32]),
    "bins": (bins, [8, 12, 16, 24, 32]),
    **integer_kinds.FAMILIES,
}


def write(path, made):
    """As GAMS text and as MPS; the first `integers` columns are integer, all are at least 0."""
    cost, rows, upper, integers = made
    n = len(cost)
    with open(path + ".gms", "w") as f:
        f.write(f"set r /r1*r{len(rows)}/, j /j1*j{n}/, k(j) /j1*j{integers}/, e(r), g(r), l(r);\n")
        lists = {"a(r,j)": [(f"r{i+1}.j{j+1}", v) for i, row in enumerate(rows) for j, v in row[0]]}
        lists["b(r)"] = [(f"r{i+1}", row[2]) for i, row in enumerate(rows)]
        lists["s(r)"] = [(f"r{i+1}", "EGL".index(row[1]) + 1) for i, row in enumerate(rows)]
        lists["c(j)"] = [(f"j{j+1}", v) for j, v in enumerate(cost)]
        lists["u(j)"] = [(f"j{j+1}", v) for j, v in enumerate(upper)]
        for name, entries in lists.items():
            f.write(f"parameter {name} /\n" + "\n".join(f"{k} {v}" for k, v in entries) + "\n/;\n")
        f.write("""e(r) = s(r) = 1; g(r) = s(r) = 2; l(r) = s(r) = 3;
integer variable n(j); positive variable x(j); free variable z; n.up(j) = u(j); x.up(j) = u(j);
equations obj, eq(r), ge(r), le(r);
obj..      z =e= sum(k, c(k)*n(k)) + sum(j$(not k(j)), c(j)*x(j));
eq(e(r)).. sum(k, a(r,k)*n(k)) + sum(j$(not k(j)), a(r,j)*x(j)) =e= b(r);
ge(g(r)).. sum(k, a(r,k)*n(k)) + sum(j$(not k(j)), a(r,j)*x(j)) =g= b(r);
le(l(r)).. sum(k, a(r,k)*n(k)) + sum(j$(not k(j)), a(r,j)*x(j)) =l= b(r);
model m /all/; m.optCR = 1e-4; solve m using mip minimizing z;
""")
    columns = [[] for _ in range(n)]
    for i, row in enumerate(rows):
        for j, v in row[0]:
            columns[j].append((i, v))
    with open(path + ".mps", "w") as f:
        f.write("NAME made\nROWS\n N obj\n" + "".join(f" {row[1]} r{i}\n" for i, row in enumerate(rows)) + "COLUMNS\n")
        for j in range(n):
            if j == 0:
                f.write(" M1 'MARKER' 'INTORG'\n")
            if j == integers:
                f.write(" M2 'MARKER' 'INTEND'\n")
            f.write(f" x{j} obj {cost[j]}\n" + "".join(f" x{j} r{i} {v}\n" for i, v in columns[j]))
        if integers == n:
            f.write(" M2 'MARKER' 'INTEND'\n")
        f.write("RHS\n" + "".join(f" rhs r{i} {row[2]}\n" for i, row in enumerate(rows)))
        f.write("BOUNDS\n" + "".join(f" UP b x{j} {upper[j]}\n" for j in range(n)) + "ENDATA\n")


def spent(command):
    """Output and processor seconds of a command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def highs(path, limit):
    """In a process of its own."""
    import time
    import highspy

    h = highspy.Highs()
    h.silent()
    for name, value in (("threads", 1), ("time_limit", limit), ("mip_rel_gap", 1e-4), ("mip_abs_gap", 0.0)):
        h.setOptionValue(name, value)
    begin = time.process_time()
    h.readModel(path)
    h.run()
    info = h.getInfo()
    print(json.dumps([time.process_time() - begin, info.objective_function_value, info.mip_node_count, info.mip_gap]))


def main():
    p = argparse.ArgumentParser()
    p.add_argument("bmod")
    p.add_argument("--limit", type=float, default=60)
    p.add_argument("--only", default="")
    p.add_argument("--solver", default="bmip")
    a = p.parse_args()
    print("| program | rows × columns | " + " | ".join(f"bmod, {s}: s, nodes" for s in a.solver.split(",")) + " | highspy: s, nodes | value |")
    print("| --- | --- |" + " --- |" * (a.solver.count(",") + 3))
    with tempfile.TemporaryDirectory() as folder:
        for name, (make, sizes) in FAMILIES.items():
            for n in sizes:
                if a.only and name not in a.only.split(","):
                    continue
                random.seed(n)
                made = make(n)
                path = os.path.join(folder, f"{name}{n}")
                write(path, made)
                cells, values = [], []
                for solver in a.solver.split(","):
                    command = [a.bmod, "run", path + ".gms", "--json", "-", "-q", "--option", f"mip={solver}"]
                    out, seconds = spent(command + ["--time-limit", str(a.limit)])
                    s = json.loads(out)["solves"][0]
                    search = s.get("search") or {}
                    done = s["solver_status"]["code"] == 1
                    gap = "" if done else f", gap {100 * (search.get('gap') or float('inf')):.1f} %"
                    cells.append(f"{seconds:.2f}, {search.get('nodes')}{gap}")
                    values.append(s["objective"])
                out, _ = spent([sys.executable, __file__, "highs:" + path + ".mps", "--limit", str(a.limit)])
                seconds, value, nodes, gap = json.loads(out.splitlines()[-1])
                cells.append(f"{seconds:.2f}, {nodes}" + (f", gap {100 * gap:.1f} %" if gap > 1.01e-4 else ""))
                values.append(value)
                same = all(v is not None and abs(v - value) <= 2e-4 * abs(value) for v in values)
                shown = f"{value:g}" if same else "; ".join("-" if v is None else f"{v:g}" for v in values)
                print(f"| {name} {n} | {len(made[1])} × {len(made[0])} | " + " | ".join(cells) + f" | {shown} |", flush=True)


if sys.argv[1:2] and sys.argv[1].startswith("highs:"):
    highs(sys.argv[1][6:], float(sys.argv[3]))
else:
    main()
