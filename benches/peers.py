"""bmod beside GAMS (CONOPT, PATH, NLPEC), HiGHS, and CasADi with its Ipopt: processor time of whole processes, answers compared.

    python3 benches/peers.py BMOD [--old BMOD] [--repeat 3] [--only lp,nlp,mcp,mpec,loop] [--netlib FOLDER] > docs/lab/peers.md

Runs the instances of ../shared/corpus (or BMOD_SHARED), models/teaching and loops of solves written here. GAMS takes part if
GAMS_DIR names its folder or the Python package gamspy_base is installed (its size limit leaves out what is larger); HiGHS needs
highspy and takes the linear programs as bmod writes them (--solution); CasADi (pip install casadi) takes the scalar instances of the
corpus, of which this file reads the few forms that occur; its time contains Python's start. A time is user and system time of the process and its children, the median
of the runs, 10 ms at least in the ratios. --old: another build of bmod. --netlib: the folder of benches/netlib.py.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

FLOOR, LIMIT = 0.01, 60
ROOT = pathlib.Path(__file__).resolve().parent.parent
CORPUS = pathlib.Path(os.environ.get("BMOD_SHARED", ROOT.parent / "shared")) / "corpus"

LOOP = {
    # a frontier of a portfolio, a plan that is rolled on, and a fit whose data change
    "frontier": """set i /1*8/, t /1*{n}/; alias(i,j); parameter q(i,j), r(i); r(i) = ord(i)+mod(3*ord(i),4);
q(i,j) = 0.2/(1+abs(ord(i)-ord(j))); q(i,i) = 0.3 + 0.1*ord(i);
positive variable x(i); variable v; scalar least; equation budget, gain, risk; budget.. sum(i, x(i)) =e= 1;
gain.. sum(i, r(i)*x(i)) =g= least; risk.. v =e= sum((i,j), x(i)*q(i,j)*x(j)) + sum(i, power(x(i),3));
model m /all/; option limrow=0, limcol=0, solprint=off; x.l(i) = 1/8;
loop(t, least = 3 + 4*ord(t)/card(t); solve m using nlp minimizing v);""",
    "plan": """set t /1*12/, k /1*{n}/; parameter d(t); scalar s0 /5/; positive variable x(t), s(t); variable c;
equation bal(t), cost; bal(t).. s(t) =e= s(t-1) + s0$(ord(t)=1) + x(t) - d(t); x.up(t) = 15;
cost.. c =e= sum(t, x(t)*(2+0.1*ord(t)) + 0.3*s(t)); model m /all/; option limrow=0, limcol=0, solprint=off;
loop(k, d(t) = 8 + 4*sin(ord(t)+ord(k)); solve m using lp minimizing c);""",
    "fit": """set p /1*20/, k /1*{n}/; parameter u(p), y(p); u(p) = ord(p)/5; variable a, b, c, f; equation ls;
ls.. f =e= sum(p, sqr(y(p) - a*exp(-b*u(p)) - c)); model m /all/; option limrow=0, limcol=0, solprint=off;
loop(k, y(p) = 3*exp(-(0.5+ord(k)/(4*card(k)))*u(p)) + 1 + 0.05*sin(7*ord(p)+ord(k)); a.l = 1; b.l = 1; c.l = 0; solve m using nlp minimizing f);""",
    "market": """set i /1*6/, k /1*{n}/; parameter c(i); scalar a; positive variable q(i); variable p; equation first(i), price;
c(i) = 2 + ord(i)/2; first(i).. c(i) + 0.1*sqr(q(i)) + q(i) =g= p; price.. p =e= a - sum(i, q(i)); model m /first.q, price.p/;
option limrow=0, limcol=0, solprint=off; loop(k, a = 20 + ord(k)/card(k)*10; solve m using mcp);""",
}


def measured(command, folder):
    """Processor seconds and what was printed."""
    def limit():
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))

    with tempfile.TemporaryFile() as out:
        p = subprocess.Popen(command, stdout=out, stderr=subprocess.DEVNULL, cwd=folder, preexec_fn=limit)
        _, _, usage = os.wait4(p.pid, 0)
        p.returncode = 0
        out.seek(0)
        return usage.ru_utime + usage.ru_stime, out.read().decode(errors="replace")


def by_bmod(program, path, folder, repeat):
    times = []
    for _ in range(repeat):
        seconds, text = measured([program, "run", str(path), "--json", "-", "--out", folder, "--time-limit", str(LIMIT)], folder)
        times.append(seconds)
    try:
        s = json.loads(text)["solves"][-1]
        return statistics.median(times), s["model_status"]["code"], s["objective"]
    except (ValueError, LookupError):
        return statistics.median(times), None, None


def gams():
    if os.environ.get("GAMS_DIR"):
        return os.path.join(os.environ["GAMS_DIR"], "gams")
    try:
        import gamspy_base
        return os.path.join(gamspy_base.directory, "gams")
    except ImportError:
        return shutil.which("gams")


def by_gams(program, path, folder, repeat):
    listing = os.path.join(folder, "out.lst")
    solvers = ["lp=conopt", "qcp=conopt", "rmip=conopt", "nlp=conopt", "mcp=path", "mpec=nlpec"]
    command = [program, str(path), "o=" + listing, "lo=0", "threads=1", "scrdir=" + folder, "curdir=" + folder, f"reslim={LIMIT}", *solvers]
    times = [measured(command, folder)[0] for _ in range(repeat)]
    text = open(listing, encoding="latin-1").read() if os.path.exists(listing) else ""
    status = re.findall(r"\*\*\*\* MODEL STATUS +(\d+)", text)
    value = re.findall(r"\*\*\*\* OBJECTIVE VALUE +(\S+)", text)
    return statistics.median(times), int(status[-1]) if status else None, float(value[-1]) if value else None


HIGHS = """
import sys; sys.path.insert(0, sys.argv[1])
import highspy
from highs import load
h = highspy.Highs(); h.setOptionValue("output_flag", False); h.setOptionValue("threads", 1); h.passModel(load(sys.argv[2], -1)); h.run()
print(1 if h.modelStatusToString(h.getModelStatus()) == "Optimal" else 0, h.getInfo().objective_function_value)
"""

CASADI = """
import re, sys
import casadi as ca
text = re.sub(r"(?m)^\\*.*$", "", open(sys.argv[1]).read())
free = re.search(r"(?is)\\n\\s*variables(.*?);", text).group(1)
positive = re.search(r"(?is)positive variables(.*?);", text)
split = lambda s: [w for w in re.split(r"[\\s,]+", s) if w]
names = split(free)
x = ca.SX.sym("x", len(names)); at = {n: k for k, n in enumerate(names)}
inf = ca.inf; low = [-inf]*len(names); high = [inf]*len(names); level = [0.0]*len(names)
for n in split(positive.group(1)) if positive else []: low[at[n]] = 0.0
for n, f, v in re.findall(r"(?i)(\\w+)\\.(lo|up|l|fx) *= *([-+.\\deE]+) *;", text):
    if n in at:
        f = f.lower(); k = at[n]; v = float(v)
        if f in ("lo", "fx"): low[k] = v
        if f in ("up", "fx"): high[k] = v
        if f in ("l", "fx"): level[k] = v
sqr = lambda a: a*a
power = lambda a, n: a**n
scope = dict(sqr=sqr, power=power, exp=ca.exp, log=ca.log, sqrt=ca.sqrt, sin=ca.sin, cos=ca.cos, abs=ca.fabs, arctan=ca.atan, tan=ca.tan,
             max=ca.fmax, min=ca.fmin, tanh=ca.tanh, **{n: x[k] for n, k in at.items()})
scope.update({k.upper(): v for k, v in scope.items() if callable(v)})
rows, a, b = [], [], []
for left, relation, right in re.findall(r"(?is)\\.\\.(.*?)=([elg])=(.*?);", text):
    value = eval("(" + left.replace("\\n", " ") + ")-(" + right.replace("\\n", " ") + ")", scope)
    rows.append(value); a.append(-inf if relation in "lL" else 0.0); b.append(inf if relation in "gG" else 0.0)
sense, z = re.search(r"(?i)using +\\w+ +(m\\w+) +(\\w+) *;", text).groups()
sign = -1 if sense.lower().startswith("max") else 1
start = [min(max(v, l), h) for v, l, h in zip(level, low, high)]
s = ca.nlpsol("s", "ipopt", dict(x=x, f=sign*x[at[z]], g=ca.vertcat(*rows)), {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"})
r = s(x0=start, lbx=low, ubx=high, lbg=a, ubg=b)
print(2 if s.stats()["return_status"] in ("Solve_Succeeded", "Solved_To_Acceptable_Level") else 0, sign*float(r["f"]))
"""


def by_python(script, arguments, folder, repeat):
    runs = [measured([sys.executable, "-c", script, *arguments], folder) for _ in range(repeat)]
    seconds = statistics.median(r[0] for r in runs)
    words = runs[-1][1].split()
    return (seconds, int(words[-2]), float(words[-1])) if len(words) >= 2 else (seconds, None, None)


def has(module):
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


def instances(folder):
    """Type, file, sense."""
    if (CORPUS / "reference.csv").exists():
        for row in csv.DictReader(open(CORPUS / "reference.csv")):
            kind = row["model_type"].lower()
            yield {"dnlp": "nlp", "qcp": "nlp"}.get(kind, kind), CORPUS / row["file"], row["sense"]
        for path in sorted((CORPUS / "mcp" / "classic").glob("*.gms")):
            yield "mcp", path, "min"
    for path in sorted((ROOT / "models" / "teaching").glob("*.blk")):
        solves = re.findall(r"(?m)^\s*solve +\w+ +using +(\w+)(?: +(m[ai]))?", path.read_text())
        kind = {"qcp": "nlp"}.get(solves[-1][0], solves[-1][0])
        if kind in ("lp", "nlp", "mcp", "mpec") and "mip" not in [k for k, _ in solves]:
            yield kind, path, "max" if solves[-1][1] == "ma" else "min"
    for name, text in LOOP.items():
        for n in (1, 3, 10, 20, 30, 50, 70, 100, 150, 200, 300, 400, 600, 800, 1000):
            path = pathlib.Path(folder) / f"{name}_{n}.gms"
            path.write_text(text.format(n=n))
            yield "loop", path, "min"


def compared(mine, other, sense):
    """What the answers say: same, better, worse, only one."""
    def solved(answer):
        return answer is not None and answer[1] in (1, 2, 8, 15, 16)
    if not solved(mine) or not solved(other):
        return "both not" if not solved(mine) and not solved(other) else "only bmod" if solved(mine) else "only other"
    if mine[2] is None or other[2] is None:
        return "same"
    gap = (mine[2] - other[2]) * (-1 if sense == "max" else 1)
    # GAMS's listing has four decimals
    return "same" if abs(gap) <= 6e-5 + 1e-5 * abs(other[2]) else "worse" if gap > 0 else "better"


def table(name, rows):
    """rows: (file, sense, mine, other)."""
    rows = [r for r in rows if r[3] is not None and r[3][1] is not None]
    if not rows:
        return
    ratio = [(max(FLOOR, m[0]) / max(FLOOR, o[0]), f, m, o) for f, _, m, o in rows]
    mean = math.exp(sum(math.log(r[0]) for r in ratio) / len(ratio))
    total = sum(r[2][0] for r in ratio) / sum(r[3][0] for r in ratio)
    words = [compared(m, o, s) for _, s, m, o in rows]
    count = ", ".join(f"{words.count(w)} {w}" for w in ("same", "better", "worse", "only bmod", "only other", "both not") if w in words)
    print(f"| {name} | {len(rows)} | {mean:.2f} | {total:.2f} | {count} |")
    return sorted(ratio, key=lambda r: -r[0])[:10], [(f, w) for (f, _, _, _), w in zip(rows, words) if w in ("worse", "only other")]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bmod")
    parser.add_argument("--old")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--only", default="lp,nlp,mcp,mpec,loop")
    parser.add_argument("--netlib")
    given = parser.parse_args()
    only = given.only.split(",")
    program = os.path.abspath(given.bmod)
    peers = {}
    if gams():
        peers["GAMS"] = lambda kind, path, folder: by_gams(gams(), path, folder, given.repeat)
    if has("highspy"):
        def highs(kind, path, folder):
            if kind != "lp":
                return None
            file = os.path.join(folder, "lp.json")
            measured([program, "run", str(path), "--solution", file, "--quiet", "--out", folder], folder)
            return by_python(HIGHS, [str(ROOT / "benches"), file], folder, given.repeat)
        peers["HiGHS"] = highs
    if has("casadi"):
        peers["CasADi + Ipopt"] = lambda kind, path, folder: by_python(CASADI, [str(path)], folder, given.repeat) if kind == "nlp" else None
    if given.old:
        peers["bmod before"] = lambda kind, path, folder: by_bmod(os.path.abspath(given.old), path, folder, given.repeat)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for kind, path, sense in instances(folder):
            if kind in only:
                mine = by_bmod(program, path, folder, given.repeat)
                found.append((kind, path.stem, sense, mine, {n: p(kind, path, folder) for n, p in peers.items()}))
                print(path.stem, file=sys.stderr)
    print("# bmod beside its peers\n\nWritten by `python3 benches/peers.py`, which says what is run; processor seconds of whole processes, ratios bmod : peer.\n")
    print("| problems | number | geometric mean | sum | answers |\n| --- | --: | --: | --: | --- |")
    worst = []
    for kind in only:
        for name in peers:
            made = table(f"{kind}, {name}", [(f, s, m, o[name]) for k, f, s, m, o in found if k == kind])
            if made:
                worst.append((f"{kind}, {name}", *made))
    for name, slow, bad in worst:
        print(f"\n## {name}\n\n| the worst ten | ratio | bmod | peer |\n| --- | --: | --: | --: |")
        for ratio, f, m, o in slow:
            print(f"| {f} | {ratio:.1f} | {m[0]:.3f} | {o[0]:.3f} |")
        if bad:
            print("\nNot as good: " + ", ".join(f"{f} ({w})" for f, w in bad) + ".")
    if given.netlib:
        command = [sys.executable, str(ROOT / "benches" / "netlib.py"), "--times", program, given.netlib]
        print("\n## Netlib, HiGHS\n\n" + subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[-1])


if __name__ == "__main__":
    main()
