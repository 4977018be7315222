"""Models, data in and out, statuses, figures."""

import copy
import math
import pickle
import subprocess
import sys
import threading
import time

import numpy as np
import pandas as pd
import pytest

import bmod

TRANSPORT = """
Sets i 'plants' / seattle, san-diego /, j 'markets' / new-york, chicago, topeka /;
Parameters a(i) / seattle 350, san-diego 600 /, b(j) / new-york 325, chicago 300, topeka 275 /;
Table d(i,j)
            new-york chicago topeka
  seattle     2.5     1.7    1.8
  san-diego   2.5     1.8    1.4 ;
Scalar f / 90 /;
Parameter c(i,j);  c(i,j) = f*d(i,j)/1000;
Positive variable x(i,j);  Variable z;
Equations cost, supply(i), demand(j);
cost..      z =e= sum((i,j), c(i,j)*x(i,j));
supply(i).. sum(j, x(i,j)) =l= a(i);
demand(j).. sum(i, x(i,j)) =g= b(j);
Model transport / all /;
solve transport using lp minimizing z;
"""


@pytest.fixture
def transport():
    return bmod.Model.from_text(TRANSPORT, name="transport.blk")


def test_answers(transport):
    r = transport.solve()
    assert r.status is bmod.ModelStatus.OPTIMAL and r.status.is_solved
    assert r.objective == pytest.approx(153.675)
    x = r["x"]
    assert list(x.columns) == ["level", "marginal", "lower", "upper"]
    assert x.index.names == ["i", "j"]
    assert x.level["seattle", "chicago"] == pytest.approx(300)
    assert x.upper["seattle", "chicago"] == math.inf
    assert r["z"].level == pytest.approx(153.675)
    assert r["demand"].marginal["new-york"] == pytest.approx(0.225)
    assert r["c"]["seattle", "new-york"] == pytest.approx(0.225)
    assert r["f"] == 90
    assert list(r["J"]) == ["new-york", "chicago", "topeka"]
    assert r.residuals.primal < 1e-9
    assert [s.model for s in r.solves] == ["transport"]
    assert "transport" in repr(r) and "<table>" in r._repr_html_()


@pytest.mark.parametrize(
    "demand",
    [
        {"new-york": 100, "chicago": 100.0, "topeka": 0},
        pd.Series([100, 100, 0], index=["new-york", "chicago", "topeka"]),
        pd.DataFrame({"value": [100, 100, 0]}, index=["new-york", "chicago", "topeka"]),
        pd.DataFrame({"j": ["new-york", "chicago"], "value": [100, 100]}),
        np.array([100, 100, 0]),
        [100, 100, 0],
    ],
    ids=["dict", "series", "frame", "columns", "array", "list"],
)
def test_data_of_every_shape(transport, demand):
    transport["b"] = demand
    r = transport.run()
    assert r["demand"].level.get("topeka", 0) == 0
    assert r.objective == pytest.approx(0.09 * (2.5 * 100 + 1.7 * 100))


def test_tables_and_arrays_of_two_dimensions(transport):
    table = pd.DataFrame([[1, 2, 3], [4, 5, 6.0]], index=["seattle", "san-diego"], columns=["new-york", "chicago", "topeka"])
    transport["d"] = table
    first = transport.run()["d"]
    transport["d"] = table.to_numpy()
    assert transport.run()["d"].equals(first)
    assert first["san-diego", "chicago"] == 5
    transport["d"] = table.stack()
    assert transport.run()["d"].equals(first)


def test_sets_then_parameters():
    m = bmod.Model.from_text("set i / a /; parameter p(i) / a 1 /; scalar s; s = sum(i, p(i));")
    m["i"] = ["x", "y", 3]
    m["p"] = {"x": 1, 3: 10}
    assert m.run()["s"] == 11
    assert list(m["i"]) == ["x", "y", "3"]
    m["i"] = {"x": "the first"}
    m["p"] = {"x": 5}
    r = m.run()
    assert r["s"] == 5 and r.texts("i")["x"] == "the first"
    del m["i"], m["p"]
    assert m.run()["s"] == 1


def test_two_dimensional_sets():
    m = bmod.Model.from_text("set i / a, b /, arc(i,i); scalar n; n = card(arc);")
    m["arc"] = [("a", "b"), ("b", "a")]
    r = m.run()
    assert r["n"] == 2 and list(r["arc"]) == [("a", "b"), ("b", "a")]


@pytest.mark.parametrize(
    "name, data, words",
    [
        ("b", {"new-york": float("nan")}, "NaN"),
        ("b", {"new-york": "many"}, "not a number"),
        ("b", {("new-york", "x"): 1}, "1 index position"),
        ("b", 5, "1 index position"),
        ("b", [1, 2], "shape"),
        ("b", {"new-york": 1, "New-York ": 2}, "twice"),
        ("b", pd.Series([1.0, 2.0], index=["chicago", "chicago"]), "twice"),
        ("b", pd.Series([1.0], index=[None]), "no label"),
        ("b", {"new-york": 1j}, "not a number"),
        ("b", object(), "object"),
        ("d", {("a",): 1, ("a", "b"): 2}, "labels"),
        ("i", "seattle", "list"),
        ("i", ["a", "a"], "twice"),
        ("x", {("seattle", "topeka"): 1}, "variable"),
    ],
)
def test_bad_data_name_the_symbol(transport, name, data, words):
    with pytest.raises(bmod.DataError, match=words) as e:
        transport[name] = data
    assert f"`{name}`" in str(e.value)
    assert transport.run().objective == pytest.approx(153.675)


def test_unknown_symbols(transport):
    with pytest.raises(bmod.UnknownSymbolError, match="did you mean"):
        transport["dd"] = 1
    with pytest.raises(KeyError):
        transport.run()["nothing"]


def test_a_label_outside_the_domain_has_a_place(transport):
    transport["b"] = {"boston": 5}
    with pytest.raises(bmod.CompilationError, match="boston") as e:
        transport.run()
    d = e.value.errors[0]
    assert d.place.file == "transport.blk" and d.place.line == 3


def test_errors():
    with pytest.raises(bmod.CompilationError) as e:
        bmod.Model.from_text("scalar a;\na = b + 1;", name="m.blk").run()
    assert (e.value.errors[0].place.line, e.value.errors[0].place.column) == (2, 5)
    with pytest.raises(bmod.AbortError, match="enough"):
        bmod.Model.from_text("abort 'enough';").run()
    with pytest.raises(bmod.ExecutionError):
        bmod.Model.from_text("scalar a, b; a = 1; b = a / (a - 1);").run()
    with pytest.raises(OSError):
        bmod.Model.from_file("there/is/no/such.blk")
    r = bmod.Model.from_text("scalar a; a = b;").run(check=False)
    assert not r.ok and r.diagnostics[0].severity == "error"


def test_files_defines_and_figures(tmp_path):
    (tmp_path / "size.inc").write_text("scalar n / %size% /;")
    (tmp_path / "m.blk").write_text(
        "$include size.inc\nfigure f { points x = n, y = 1; };\ndraw f 'f.svg';\nfile out / o.txt /; put out 'text'; putclose;"
    )
    r = bmod.Model.from_file(tmp_path / "m.blk", define={"size": 7}).run()
    assert r["n"] == 7
    assert r.figures["f"]._repr_svg_().startswith("<svg")
    assert r.files["o.txt"].startswith(b"text")
    assert not (tmp_path / "f.svg").exists()
    r.save(tmp_path / "out")
    assert (tmp_path / "out" / "f.svg").exists()


def test_callbacks_and_their_exceptions(transport):
    printed = []
    transport.run(on_print=printed.append)
    assert "optimal" in "".join(printed)

    def fails(text):
        raise RuntimeError("from the callback")

    with pytest.raises(RuntimeError, match="from the callback"):
        transport.run(on_print=fails)


def test_time_limit_and_options(transport):
    assert transport.run(options={"lp": "simplex"}).solves[0].solver.startswith("simplex")
    m = bmod.Model.from_text("scalar n / 0 /; while(1, n = n + 1);")
    start = time.time()
    r = m.run(time_limit=0.3, check=False)
    assert r.stopped and time.time() - start < 10


def test_threads_run_side_by_side():
    m = bmod.Model.from_text("scalar n / 0 /; while(n < 100000, n = n + 1);")
    ticks = []

    def work():
        ticks.append(m.run()["n"])

    threads = [threading.Thread(target=work) for _ in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert ticks == [100000] * 4


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_returns_what_was_found():
    code = (
        "import bmod, os, signal, threading, warnings\n"
        "warnings.simplefilter('ignore')\n"
        # ignored where the tests run in the background of a script
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        "r = bmod.Model.from_text('scalar n / 0 /; while(1, n = n + 1);').run()\n"
        "print(r.stopped, r.interrupted, r['n'] > 0)\n"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert out.stdout.split() == ["True", "True", "True"], out.stderr


#: Knapsacks that are far from proved within seconds.
LONG = """
Set i / i1*i120 /, k / k1*k30 /;
Parameter w(i,k), v(i);  w(i,k) = uniformInt(10, 99);  v(i) = round(sum(k, w(i,k))/card(k)) + uniformInt(1, 9);
Binary variable x(i);  Variable z;  Equations value, fits(k);
value.. z =e= sum(i, v(i)*x(i));  fits(k).. sum(i, w(i,k)*x(i)) =l= 2500;
Model m / all /;  option optCr = 0;  solve m using mip maximizing z;
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_stops_a_solve_at_its_best_point():
    code = (
        "import bmod, os, signal, sys, warnings\n"
        "warnings.simplefilter('ignore')\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "best = lambda message, seconds: 'objective' in message and os.kill(os.getpid(), signal.SIGINT)\n"
        "r = bmod.Model(sys.argv[1]).run(on_progress=best)\n"
        "print(r.interrupted, r.status.name, r.objective > 0, r.residuals.primal < 1e-6)\n"
    )
    out = subprocess.run([sys.executable, "-c", code, LONG], capture_output=True, text=True, timeout=60)
    assert out.stdout.split() == ["True", "INTEGER_SOLUTION", "True", "True"], (out.stdout, out.stderr)


def test_exceptions_in_progress():
    def fails(message, seconds):
        raise RuntimeError("from the callback")

    start = time.time()
    with pytest.raises(RuntimeError, match="from the callback"):
        bmod.Model(LONG).run(on_progress=fails)
    assert time.time() - start < 30


def test_command_line(tmp_path):
    (tmp_path / "m.blk").write_text("scalar n / 3 /; display n;")
    out = subprocess.run([sys.executable, "-m", "bmod", "run", str(tmp_path / "m.blk")], capture_output=True, text=True)
    assert out.returncode == 0 and "3.000" in out.stdout


def test_models_are_values(transport):
    other = transport.copy()
    other["f"] = 180
    assert other.run().objective == pytest.approx(2 * 153.675)
    assert transport.run().objective == pytest.approx(153.675)
    assert str(transport.symbols["d"]) == "d(i,j)"


def test_data_matched_by_index_names(transport):
    """Where the data name all index sets, their order does not matter."""
    table = pd.DataFrame([[1, 2, 3], [4, 5, 6.0]], index=["seattle", "san-diego"], columns=["new-york", "chicago", "topeka"])
    transport["d"] = table
    first = transport["d"]
    long = table.rename_axis(index="i", columns="j").T.stack()
    assert long.index.names == ["j", "i"]
    for data in (long, long.to_frame("value"), long.rename("value").reset_index()):
        transport["d"] = data
        assert transport["d"].equals(first)
    transport["d"] = table.rename_axis(index="i", columns="j").T
    assert transport["d"].equals(first)


def test_xarray(transport):
    xarray = pytest.importorskip("xarray")
    array = xarray.DataArray(
        np.arange(6.0).reshape(3, 2) + 1,
        dims=["j", "i"],
        coords={"i": ["seattle", "san-diego"], "j": ["new-york", "chicago", "topeka"]},
    )
    transport["d"] = array
    assert transport["d"]["seattle", "topeka"] == 5
    transport["f"] = xarray.DataArray(45.0)
    r = transport.run()
    assert r["f"] == 45
    assert float(r["x"].to_xarray().level.sum()) == pytest.approx(900)


def test_pickled_copied_and_full(transport):
    transport["b"] = [100, 100, 0]
    for other in (pickle.loads(pickle.dumps(transport)), copy.deepcopy(transport), transport.copy()):
        assert other.run().objective == transport.run().objective
        assert other.digest() == transport.digest()
        other["f"] = 9
        assert other.digest() != transport.digest()
    r = transport.run()
    again = pickle.loads(pickle.dumps(r))
    assert again["x"].equals(r["x"]) and again.status is r.status and again.to_json() == r.to_json()
    assert list(again) == list(r) and "x" in again and "nothing" not in again
    full = again.full("x")
    assert len(full) == 6 and full.level.sum() == 200 and full.upper.eq(math.inf).all()
    assert r.full("b")["topeka"] == 0 and r.full("z").level == r.objective


def test_the_next_run_starts_at_the_last_basis(transport):
    transport.run()
    for k in range(5):
        transport["b"] = [325, 300, 275 - k]
        r = transport.run()
        assert r.solves[0].iterations <= 1
    fresh = bmod.Model.from_text(TRANSPORT, data={"b": [325, 300, 271]})
    assert fresh.run().objective == pytest.approx(r.objective)
    assert fresh.run().solves[0].iterations == 0 and r.solves[0].status is bmod.ModelStatus.OPTIMAL


def test_a_thousand_solves_cost_their_pivots(transport):
    """New data each time: the basis is kept, and what it costs is the pivots from one answer to the next."""
    fresh = transport.run().solves[0].iterations
    pivots = 0
    for k in range(1000):
        transport["b"] = [325 - k % 50, 300 - k % 7, 275 - k % 11]
        r = transport.run()
        pivots += r.solves[0].iterations
    assert fresh > 0 and pivots < 1000 * fresh / 4
    again = bmod.Model.from_text(TRANSPORT, data={"b": list(transport["b"])})
    assert r.objective == pytest.approx(again.run().objective)


def test_update_and_logging(transport, caplog):
    transport.update({"f": 45, "b": {"new-york": 100}})
    with caplog.at_level("INFO", logger="bmod"):
        r = transport.run(progress=True)
    assert "transport using lp: optimal" in caplog.text
    assert r.objective == pytest.approx(0.045 * 250)
    assert list(transport)[:2] == ["i", "j"] and "X" in transport
    with pytest.raises(bmod.DataError, match="`x` is a variable"):
        transport["x"]
    with pytest.raises(TypeError, match="from_file"):
        bmod.Model.from_text(5)


def test_formulas(transport):
    shown = transport.show()
    assert "minimize  z" in str(shown) and "<math>" in shown._repr_html_() and r"\documentclass" in shown.latex
    assert r"\documentclass" not in transport._repr_latex_()
    dual = transport.dual(check=True)
    assert dual.passed and dual.model().run().objective == pytest.approx(153.675)
    kkt = transport.kkt()
    assert kkt.title and kkt.model().run().status.is_solved
    with pytest.raises(ValueError):
        shown.model()
    with pytest.raises(bmod.ModelError, match="no model"):
        bmod.Model("scalar a / 1 /;").show()
    with pytest.raises(bmod.CompilationError) as e:
        bmod.Model("scalar a / 1 ").show()
    assert e.value.errors[0].place.line == 1
    assert "E0203" in bmod.Model("scalar a / 1 ")._repr_html_()


def test_import_is_light():
    code = "import sys, bmod; print(sorted({'numpy', 'pandas', 'IPython', 'pyarrow', 'xarray'} & set(sys.modules)))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert out.stdout.strip() == "[]", out.stderr


def test_warnings():
    m = bmod.Model.from_text("scalar s / 1 /; execute 'program';")
    with pytest.warns(bmod.ModelWarning):
        m.run()


def test_many_records():
    n = 300_000
    m = bmod.Model.from_text("set i; parameter p(i<); scalar s; s = sum(i, p(i));")
    labels = [f"l{k}" for k in range(n)]
    m["p"] = pd.Series(np.ones(n), index=labels)
    r = m.run()
    assert r["s"] == n and len(r["p"]) == n and r["p"].index[5] == "l5"


def test_series_for_sets():
    m = bmod.Model("set i, j; scalar n; n = card(i);")
    for data, labels in [
        (pd.Series(["b", "a"]), ["b", "a"]),
        (pd.Series(["x", "y", "z"])[1:], ["y", "z"]),  # filtered: the index still counts
        (pd.Series({"b": "the first", "a": None}), ["b", "a"]),
        (pd.Series({"b": True, "c": False, "a": True}), ["b", "a"]),
    ]:
        m["i"] = data
        assert sorted(m["i"]) == sorted(labels)
    m["i"] = pd.Series({"b": "the first", "a": None})
    assert dict(m.run().texts("i")) == {"a": "", "b": "the first"}
    with pytest.raises(bmod.DataError, match="`i`.*s.index"):
        m["i"] = pd.Series({"a": 1, "b": 2})
    with pytest.raises(bmod.DataError, match=r"`i`: \['a'\] is not a label; several labels are a tuple"):
        m["i"] = [["a"]]


def test_a_column_of_values_by_any_name(transport):
    data = {"i": ["seattle"], "j": ["topeka"], "cost": [7.0]}
    transport["d"] = pd.DataFrame(data)
    assert dict(transport["d"]) == {("seattle", "topeka"): 7}
    transport["d"] = pd.DataFrame(data)[["j", "i", "cost"]]
    assert dict(transport["d"]) == {("seattle", "topeka"): 7}
    with pytest.raises(bmod.DataError, match="`b`.*no labels"):
        transport["b"] = pd.DataFrame({"value": [1, 2, 3]})
    # An empty cell of a table is no record; NaN anywhere else is wrong.
    table = pd.DataFrame([[1, math.nan]], index=["seattle"], columns=["topeka", "chicago"])
    transport["d"] = table
    assert dict(transport["d"]) == {("seattle", "topeka"): 1}
    with pytest.raises(bmod.DataError, match="NaN"):
        transport["d"] = table.T.unstack()


@pytest.mark.parametrize("limit", [math.nan, 0, -1, math.inf])
def test_time_limits_that_are_none(transport, limit):
    with pytest.raises(ValueError, match="time_limit"):
        transport.run(time_limit=limit)
    with pytest.raises(ValueError, match="time_limit"):
        bmod.sweep(TRANSPORT, {"f": [1]}, time_limit=limit, progress=False)


def test_data_given_while_a_run_is_under_way():
    """They are for the next run."""
    m = bmod.Model("scalar k / 1 /; display k;")

    def give(_):
        m["k"] = 3

    assert m.run(on_print=give)["k"] == 1
    assert m.run()["k"] == 3


def test_what_a_notebook_shows(transport):
    shown = transport._repr_mimebundle_(include=None, exclude=None)
    assert set(shown) == {"text/plain", "text/html", "text/latex"} and "<math>" in shown["text/html"]
    shown = transport.run()._repr_mimebundle_()
    assert "optimal" in shown["text/plain"] and "<table>" in shown["text/html"]
    assert "E0203" in bmod.Model("scalar a / 1 ")._repr_mimebundle_()["text/html"]
