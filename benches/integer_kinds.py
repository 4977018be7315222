"""Kinds of mixed-integer programs that people write: the second half of what `integers.py` measures."""
import math
import random


class Made:
    """Integers come first in the end: columns are named as they come."""

    def __init__(self):
        self.integer, self.real, self.rows = [], [], []

    def whole(self, cost=0, upper=1):
        self.integer.append((cost, upper))
        return ("i", len(self.integer) - 1)

    def column(self, cost=0, upper=1e5):
        self.real.append((cost, upper))
        return ("r", len(self.real) - 1)

    def row(self, terms, sense, side):
        self.rows.append((terms, sense, side))

    def done(self):
        k = len(self.integer)
        number = lambda c: c[1] if c[0] == "i" else k + c[1]
        rows = []
        for terms, sense, side in self.rows:
            sums = {}
            for c, v in terms:
                sums[number(c)] = sums.get(number(c), 0) + v
            rows.append((list(sums.items()), sense, side))
        every = self.integer + self.real
        return [c for c, _ in every], rows, [u for _, u in every], k


def jobshop(n):
    """n jobs on n machines, disjunctions by a large number."""
    m, p = Made(), {}
    route = [random.sample(range(n), n) for _ in range(n)]
    t = [[random.randint(1, 20) for _ in range(n)] for _ in range(n)]
    big = sum(map(sum, t))
    last = m.column(1, big)
    start = [[m.column(0, big) for _ in range(n)] for _ in range(n)]
    for j in range(n):
        for k in range(n - 1):
            m.row([(start[j][k + 1], 1), (start[j][k], -1)], "G", t[j][k])
        m.row([(last, 1), (start[j][-1], -1)], "G", t[j][-1])
    for i in range(n):
        for a in range(n):
            for b in range(a):
                ka, kb, y = route[a].index(i), route[b].index(i), m.whole()
                m.row([(start[a][ka], 1), (start[b][kb], -1), (y, big)], "G", t[b][kb])
                m.row([(start[b][kb], 1), (start[a][ka], -1), (y, -big)], "G", t[a][ka] - big)
    return m.done()


def tardiness(n):
    """One machine, weighted tardiness, pairs by a large number."""
    m = Made()
    p = [random.randint(1, 12) for _ in range(n)]
    due = [random.randint(2, int(0.7 * sum(p))) for _ in range(n)]
    w = [random.randint(1, 9) for _ in range(n)]
    big = sum(p)
    s = [m.column(0, big) for _ in range(n)]
    for j in range(n):
        late = m.column(w[j], big)
        m.row([(late, 1), (s[j], -1)], "G", p[j] - due[j])
    for a in range(n):
        for b in range(a):
            y = m.whole()
            m.row([(s[a], 1), (s[b], -1), (y, big)], "G", p[b])
            m.row([(s[b], 1), (s[a], -1), (y, -big)], "G", p[a] - big)
    return m.done()


def salesman(n):
    """Miller, Tucker and Zemlin."""
    m = Made()
    at = [(random.random(), random.random()) for _ in range(n)]
    d = lambda i, j: round(100 * ((at[i][0] - at[j][0]) ** 2 + (at[i][1] - at[j][1]) ** 2) ** 0.5)
    x = {(i, j): m.whole(d(i, j)) for i in range(n) for j in range(n) if i != j}
    u = [m.column(0, n) for _ in range(n)]
    for i in range(n):
        m.row([(x[i, j], 1) for j in range(n) if j != i], "E", 1)
        m.row([(x[j, i], 1) for j in range(n) if j != i], "E", 1)
    for i in range(1, n):
        for j in range(1, n):
            if i != j:
                m.row([(u[i], 1), (u[j], -1), (x[i, j], n)], "L", n - 1)
    return m.done()


def routing(n):
    """n customers, 3 vehicles, loads as in Miller, Tucker and Zemlin."""
    m = Made()
    at = [(random.random(), random.random()) for _ in range(n + 1)]
    q = [0] + [random.randint(5, 25) for _ in range(n)]
    cap = int(sum(q) / 3 * 1.25)
    d = lambda i, j: round(100 * ((at[i][0] - at[j][0]) ** 2 + (at[i][1] - at[j][1]) ** 2) ** 0.5)
    N = range(n + 1)
    x = {(i, j): m.whole(d(i, j)) for i in N for j in N if i != j}
    u = [m.column(0, cap) for _ in N]
    for i in range(1, n + 1):
        m.row([(x[i, j], 1) for j in N if j != i], "E", 1)
        m.row([(x[j, i], 1) for j in N if j != i], "E", 1)
        m.row([(u[i], 1)], "G", q[i])
    m.row([(x[0, j], 1) for j in range(1, n + 1)], "L", 3)
    for i in range(1, n + 1):
        for j in range(1, n + 1):
            if i != j:
                m.row([(u[j], 1), (u[i], -1), (x[i, j], -cap)], "G", q[j] - cap)
    return m.done()


def commitment(n):
    """n units, 24 hours, start-ups, minimum up time of 4, ramps, reserve."""
    m, T = Made(), 24
    P = [random.randint(60, 300) for _ in range(n)]
    c = [random.uniform(10, 40) for _ in range(n)]
    load = [sum(P) * (0.45 + 0.25 * math.sin((t - 6) / 24 * 6.28)) for t in range(T)]
    u = [[m.whole(round(3 * c[g] + 50)) for t in range(T)] for g in range(n)]
    s = [[m.whole(round(P[g] * random.uniform(3, 6))) for t in range(T)] for g in range(n)]
    p = [[m.column(round(c[g], 2)) for t in range(T)] for g in range(n)]
    for g in range(n):
        low = round(0.35 * P[g])
        for t in range(T):
            m.row([(p[g][t], 1), (u[g][t], -P[g])], "L", 0)
            m.row([(p[g][t], 1), (u[g][t], -low)], "G", 0)
            if t:
                m.row([(u[g][t], 1), (u[g][t - 1], -1), (s[g][t], -1)], "L", 0)
                ramp = round(0.4 * P[g])
                m.row([(p[g][t], 1), (p[g][t - 1], -1)], "L", ramp)
                m.row([(p[g][t - 1], 1), (p[g][t], -1)], "L", ramp)
            m.row([(s[g][k], 1) for k in range(max(0, t - 3), t + 1)] + [(u[g][t], -1)], "L", 0)
    for t in range(T):
        m.row([(p[g][t], 1) for g in range(n)], "E", round(load[t], 1))
        m.row([(u[g][t], P[g]) for g in range(n)], "G", round(1.1 * load[t], 1))
    return m.done()


def location(n):
    """n places with capacities and fixed costs, 3n customers, weak links."""
    m = Made()
    d = [random.randint(5, 35) for _ in range(3 * n)]
    cap = [random.randint(60, 160) for _ in range(n)]
    y = [m.whole(random.randint(200, 500)) for _ in range(n)]
    x = [[m.column(random.randint(2, 20)) for _ in d] for _ in range(n)]
    for k in range(3 * n):
        m.row([(x[i][k], 1) for i in range(n)], "E", d[k])
    for i in range(n):
        m.row([(v, 1) for v in x[i]] + [(y[i], -cap[i])], "L", 0)
    return m.done()


def design(n):
    """Fixed-charge network, n nodes, 4 commodities."""
    m = Made()
    arcs = [(i, j) for i in range(n) for j in range(n) if i != j and random.random() < 0.4]
    y = {a: m.whole(random.randint(30, 120)) for a in arcs}
    f = {(a, k): m.column(random.randint(1, 8)) for a in arcs for k in range(4)}
    for k in range(4):
        s, t = random.sample(range(n), 2)
        q = random.randint(5, 20)
        for i in range(n):
            b = q * ((i == s) - (i == t))
            slack = [(m.column(500), (i == s) and 1 or -1)] if i in (s, t) else []
            m.row([(f[a, k], 1) for a in arcs if a[0] == i] + [(f[a, k], -1) for a in arcs if a[1] == i] + slack, "E", b)
    for a in arcs:
        m.row([(f[a, k], 1) for k in range(4)] + [(y[a], -40)], "L", 0)
    return m.done()


def median(n):
    """n points, a third of a fifth open."""
    m = Made()
    at = [(random.random(), random.random()) for _ in range(n)]
    d = lambda i, j: round(100 * ((at[i][0] - at[j][0]) ** 2 + (at[i][1] - at[j][1]) ** 2) ** 0.5)
    y = [m.whole() for _ in range(n)]
    x = [[m.whole(d(i, j)) for j in range(n)] for i in range(n)]
    for j in range(n):
        m.row([(x[i][j], 1) for i in range(n)], "E", 1)
        for i in range(n):
            m.row([(x[i][j], 1), (y[i], -1)], "L", 0)
    m.row([(v, 1) for v in y], "E", max(2, n // 8))
    return m.done()


def coloring(n):
    """Graph of n vertices, colours in order."""
    m, k = Made(), max(4, n // 4 + 2)
    edges = [(i, j) for i in range(n) for j in range(i) if random.random() < 0.3]
    w = [m.whole(1) for _ in range(k)]
    x = [[m.whole() for _ in range(k)] for _ in range(n)]
    for i in range(n):
        m.row([(v, 1) for v in x[i]], "E", 1)
    for i, j in edges:
        for c in range(k):
            m.row([(x[i][c], 1), (x[j][c], 1), (w[c], -1)], "L", 0)
    for c in range(k - 1):
        m.row([(w[c], 1), (w[c + 1], -1)], "G", 0)
    return m.done()


def balancing(n):
    """Assembly line: n tasks, fewest stations."""
    m, k = Made(), max(3, n // 2)
    t = [random.randint(1, 10) for _ in range(n)]
    before = [(i, j) for j in range(n) for i in range(j) if random.random() < 0.15]
    w = [m.whole(1) for _ in range(k)]
    x = [[m.whole() for _ in range(k)] for _ in range(n)]
    for i in range(n):
        m.row([(v, 1) for v in x[i]], "E", 1)
    for s in range(k):
        m.row([(x[i][s], t[i]) for i in range(n)] + [(w[s], -15)], "L", 0)
    for i, j in before:
        m.row([(x[i][s], s) for s in range(k)] + [(x[j][s], -s) for s in range(k)], "L", 0)
    for s in range(k - 1):
        m.row([(w[s], 1), (w[s + 1], -1)], "G", 0)
    return m.done()


def rolls(n):
    """Rolls cut into n widths, which and how many from each roll."""
    m = Made()
    width = [random.randint(15, 60) for _ in range(n)]
    want = [random.randint(2, 8) for _ in range(n)]
    k = sum(w * q for w, q in zip(width, want)) // 70 + 1
    y = [m.whole(1) for _ in range(k)]
    x = [[m.whole(0, want[i]) for i in range(n)] for _ in range(k)]
    for i in range(n):
        m.row([(x[r][i], 1) for r in range(k)], "G", want[i])
    for r in range(k):
        m.row([(x[r][i], width[i]) for i in range(n)] + [(y[r], -100)], "L", 0)
        if r:
            m.row([(y[r - 1], 1), (y[r], -1)], "G", 0)
    return m.done()


def batch(n):
    """State-task network on a grid of n intervals (Kondili et al. 1993): 3 tasks in a row, two units each."""
    m, T = Made(), n
    tasks = [(2, [(80, 10), (50, 6)]), (3, [(60, 8), (70, 9)]), (1, [(90, 5), (40, 3)])]
    states = [[m.column(0 if s < 3 else -10, 2000) for t in range(T + 1)] for s in range(4)]
    w, b = {}, {}
    for i, (d, units) in enumerate(tasks):
        for u, (cap, cost) in enumerate(units):
            for t in range(T):
                if t + d <= T:
                    w[i, u, t] = m.whole(cost * 3)
                    b[i, u, t] = m.column(0.1)
                    m.row([(b[i, u, t], 1), (w[i, u, t], -cap)], "L", 0)
                    m.row([(b[i, u, t], 1), (w[i, u, t], -0.4 * cap)], "G", 0)
                m.row([(w[i, u, k], 1) for k in range(max(0, t - d + 1), t + 1) if (i, u, k) in w] or [(states[0][0], 0)], "L", 1)
    # one unit is shared by the first and the third task
    for t in range(T):
        both = [(w[i, 0, k], 1) for i in (0, 2) for k in range(max(0, t - tasks[i][0] + 1), t + 1) if (i, 0, k) in w]
        if both:
            m.row(both, "L", 1)
    for s in range(4):
        m.row([(states[s][0], 1)], "E", 500 if s == 0 else 0)
        for t in range(T):
            terms = [(states[s][t + 1], 1), (states[s][t], -1)]
            if s < 3:
                terms += [(b[s, u, t], 1) for u in (0, 1) if (s, u, t) in b]
            if s:
                d = tasks[s - 1][0]
                terms += [(b[s - 1, u, t + 1 - d], -1) for u in (0, 1) if (s - 1, u, t + 1 - d) in b]
            m.row(terms, "E", 0)
    return m.done()


def expansion(n):
    """n periods, 5 kinds of plants in whole units, 4 load blocks, limits of emissions."""
    m = Made()
    kinds = [(random.randint(400, 1500), random.uniform(5, 60), random.randint(30, 120), random.uniform(0, 1)) for _ in range(5)]
    new = [[m.whole(round(k[0] * 0.93**t), 8) for t in range(n)] for k in kinds]
    for t in range(n):
        emit = []
        for block, hours in enumerate((1, 2, 4, 3)):
            load = (400 - 80 * block) * 1.06**t
            out = [m.column(round(k[1] * hours * 0.93**t, 3)) for k in kinds]
            m.row([(o, 1) for o in out], "G", round(load, 1))
            for k, o, built in zip(kinds, out, new):
                m.row([(o, 1)] + [(built[s], -k[2]) for s in range(t + 1)], "L", 0)
            emit += [(o, round(hours * k[3], 3)) for k, o in zip(kinds, out)]
        m.row(emit, "L", round(1400 * 1.03**t, 1))
    return m.done()


def shifts(n):
    """n workers, 7 days, 3 shifts, rests and wishes."""
    m = Made()
    x = {(i, d, s): m.whole(random.randint(0, 9)) for i in range(n) for d in range(7) for s in range(3)}
    for d in range(7):
        for s in range(3):
            m.row([(x[i, d, s], 1) for i in range(n)], "G", max(1, n // 5 + (s == 0)))
    for i in range(n):
        for d in range(7):
            m.row([(x[i, d, s], 1) for s in range(3)], "L", 1)
            if d:
                m.row([(x[i, d - 1, 2], 1), (x[i, d, 0], 1)], "L", 1)
        m.row([(x[i, d, s], 1) for d in range(7) for s in range(3)], "L", 5)
        m.row([(x[i, d, s], 1) for d in range(7) for s in range(3)], "G", 3)
    return m.done()


def packing(n):
    """n boxes in a strip of width 10: left, right, below, above."""
    m = Made()
    w = [random.randint(2, 6) for _ in range(n)]
    h = [random.randint(1, 5) for _ in range(n)]
    H = sum(h)
    top = m.column(1, H)
    x = [m.column(0, 10 - w[i]) for i in range(n)]
    y = [m.column(0, H) for i in range(n)]
    for i in range(n):
        m.row([(top, 1), (y[i], -1)], "G", h[i])
        for j in range(i):
            z = [m.whole() for _ in range(4)]
            m.row([(v, 1) for v in z], "G", 1)
            m.row([(x[i], 1), (x[j], -1), (z[0], 10)], "L", 10 - w[i])
            m.row([(x[j], 1), (x[i], -1), (z[1], 10)], "L", 10 - w[j])
            m.row([(y[i], 1), (y[j], -1), (z[2], H)], "L", H - h[i])
            m.row([(y[j], 1), (y[i], -1), (z[3], H)], "L", H - h[j])
    return m.done()


FAMILIES = {
    "jobshop": (jobshop, [6, 7, 8]),
    "tardiness": (tardiness, [9, 11, 13]),
    "salesman": (salesman, [15, 20, 25, 30]),
    "routing": (routing, [8, 11, 13]),
    "commitment": (commitment, [10, 20]),
    "location": (location, [15, 30]),
    "design": (design, [12, 16, 20]),
    "median": (median, [25]),
    "coloring": (coloring, [18, 25]),
    "balancing": (balancing, [20, 26, 30]),
    "rolls": (rolls, [8, 11]),
    "batch": (batch, [20, 30]),
    "expansion": (expansion, [10, 20]),
    "shifts": (shifts, [20]),
    "packing": (packing, [6, 7, 8]),
}
