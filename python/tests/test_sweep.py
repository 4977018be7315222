"""Sweeps: rows, resuming, failures."""

import concurrent.futures as futures
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import pandas as pd
import pytest

import bmod
import bmod._sweep

pytest.importorskip("pyarrow")

MODEL = """
scalar need / 1 /, price / %price% /;
positive variable x; variable cost; equations total, enough;
total.. cost =e= price*x;
enough.. x =g= need;
model m / all /; solve m using lp minimizing cost;
abort$(need > 3) 'too much';
"""


def test_rows_in_order_and_resumed(tmp_path):
    grid = {"price": [1.0, 2.0], "need": [1, 2, 4]}
    with futures.ThreadPoolExecutor(2) as pool:
        table = bmod.sweep(MODEL, grid, executor=pool, out=tmp_path / "r", outputs=["x"], progress=False)
        assert list(table.price) == [1, 1, 1, 2, 2, 2]
        assert list(table.objective[:2]) == [1, 2] and list(table.x[:2]) == [1, 2]
        assert list(table.run) == ["ok", "ok", "aborted"] * 2
        assert "too much" in table.messages[2]
        before = {f.name: f.stat().st_mtime_ns for f in (tmp_path / "r").glob("_part-*")}
        again = bmod.sweep(MODEL, grid, executor=pool, out=tmp_path / "r", outputs=["x"], progress=False)
        assert before == {f.name: f.stat().st_mtime_ns for f in (tmp_path / "r").glob("_part-*")}
    assert again.drop(columns="seconds").equals(table.drop(columns="seconds"))


def test_the_table_on_disk_has_all_columns(tmp_path, monkeypatch):
    """Also those that no row of the first part has."""
    monkeypatch.setattr(bmod._sweep, "ROWS_PER_PART", 1)
    with futures.ThreadPoolExecutor(1) as pool:
        table = bmod.sweep(MODEL, {"price": [1.0], "need": [4, 1]}, executor=pool, outputs=["x"], out=tmp_path, progress=False)
    assert len(list(tmp_path.glob("_part-*"))) == 2 and "x" in table
    assert pd.read_parquet(tmp_path / "results.parquet").equals(table) and pd.read_parquet(tmp_path).equals(table)


def test_processes():
    table = bmod.sweep(MODEL, {"price": [3.0, 4.0]}, executor=None, progress=False)
    assert list(table.objective) == [3, 4]


#: Takes a fifth of a second on any machine.
SLOW = """
scalar n / 0 /, price / %price% /;
while(timeElapsed < 0.2, n = n + 1);
positive variable x; variable cost; equations total, enough;
total.. cost =e= price*x;  enough.. x =g= 1;
model m / all /; solve m using lp minimizing cost;
"""


def same(a, b):
    return a.drop(columns="seconds").equals(b.drop(columns="seconds"))


def stored(folder):
    import pyarrow.parquet as parquet

    return [row["key"] for f in folder.glob("_part-*.parquet") for row in parquet.read_table(f).to_pylist()]


def test_a_killed_process_loses_nothing(tmp_path):
    """One of the processes of a sweep dies on the way; its run, and those that waited, are run again."""
    grid = {"price": [float(k) for k in range(1, 25)]}
    killed = []

    def kill():
        deadline = time.monotonic() + 60
        while not (children := multiprocessing.active_children()) and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.5)  # of more than two seconds of work
        for child in children[:1]:
            os.kill(child.pid, signal.SIGKILL)
            killed.append(child.pid)

    killer = threading.Thread(target=kill)
    killer.start()
    table = bmod.sweep(SLOW, grid, jobs=2, out=tmp_path / "r", progress=False)
    killer.join()
    assert killed and list(table.objective) == grid["price"]
    assert len(stored(tmp_path / "r")) == len(set(stored(tmp_path / "r"))) == 24


def test_killed_and_resumed(tmp_path):
    grid = {"price": [float(k) for k in range(1, 25)]}
    code = (
        "import bmod, sys\nimport bmod._sweep\nbmod._sweep.ROWS_PER_PART = 3\n"
        f"bmod.sweep({SLOW!r}, {grid!r}, jobs=2, out=sys.argv[1], progress=False)"
    )
    work = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "r")])
    until = time.time() + 60
    while time.time() < until and work.poll() is None and not list(tmp_path.glob("r/_part-*.parquet")):
        time.sleep(0.02)
    work.kill()
    work.wait()
    before = stored(tmp_path / "r")
    assert 0 < len(before)
    resumed = bmod.sweep(SLOW, grid, jobs=2, out=tmp_path / "r", progress=False)
    assert len(stored(tmp_path / "r")) == len(set(stored(tmp_path / "r"))) == 24
    assert same(resumed, bmod.sweep(SLOW, grid, jobs=2, progress=False))


def test_rows_of_the_command_are_known(tmp_path):
    (tmp_path / "m.blk").write_text(MODEL)
    command = [sys.executable, "-m", "bmod", "sweep", str(tmp_path / "m.blk"), "-D", "price=1:2:0.5", "-D", "need=1,2,4",
               "-j", "2", "--output", "x", "--out", str(tmp_path / "r")]
    first = subprocess.run(command, capture_output=True, text=True)
    assert first.returncode == 0 and "9 of 9 runs: 3 aborted, 6 optimal" in first.stdout, first
    rows = (tmp_path / "r" / "rows-1.jsonl").read_text()
    assert len(rows.splitlines()) == 9
    # Half a line that a killed process has left is cut off, and the run is repeated.
    (tmp_path / "r" / "rows-1.jsonl").write_text(rows[:-40])
    assert subprocess.run(command, capture_output=True, text=True).stdout == first.stdout
    by_command = pd.read_csv(tmp_path / "r" / "results.csv")
    assert list(by_command.price) == [1, 1, 1, 1.5, 1.5, 1.5, 2, 2, 2]
    grid = {"price": [1.0, 1.5, 2.0], "need": [1, 2, 4]}
    table = bmod.sweep(tmp_path / "m.blk", grid, outputs=["x"], out=tmp_path / "r", jobs=2, progress=False)
    assert not list((tmp_path / "r").glob("_part-*.parquet")), "nothing was run again"
    assert table.objective.equals(by_command.objective)
    script = subprocess.run([*command, "--slurm", "3"], capture_output=True, text=True)
    assert script.returncode == 0, script
    text = (tmp_path / "r" / "sweep.sh").read_text()
    assert "#SBATCH --array=1-3" in text
    for task in "123":
        done = subprocess.run(["bash", "-c", "bmod() { %s -m bmod \"$@\"; }; . %s" % (sys.executable, tmp_path / "r" / "sweep.sh")],
                              env={**os.environ, "SLURM_ARRAY_TASK_ID": task}, capture_output=True, text=True)
        assert "3 of 3 runs" in done.stdout, done


def test_dask_with_a_worker_killed(tmp_path):
    """A cluster of two worker processes, one of them killed on the way: nothing lost, nothing twice."""
    distributed = pytest.importorskip("distributed")
    grid = {"price": [float(k) for k in range(1, 41)]}
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            first = sorted(client.run(os.getpid).values())
            assert len(first) == 2
            killed = []

            def kill():
                os.kill(first[0], signal.SIGKILL)
                killed.append(first[0])

            timer = threading.Timer(0.4, kill)
            timer.start()
            with client.get_executor() as executor:
                table = bmod.sweep(SLOW, grid, executor=executor, out=tmp_path / "r", progress=False)
            timer.join()
            assert killed and first[0] not in client.run(os.getpid).values()
    assert list(table.run) == ["ok"] * 40 and list(table.objective) == grid["price"]
    assert len(stored(tmp_path / "r")) == len(set(stored(tmp_path / "r"))) == 40


def test_names_and_numbers_of_numpy():
    np = pytest.importorskip("numpy")
    text = "$if not set f $set f 0.65\nscalar s;\nset i / a /;\nparameter p(i);\ns = %f%;\n"
    for values in (np.arange(1, 3), np.array([0.5, 1.5], dtype=np.float32), [np.float64(2)]):
        with futures.ThreadPoolExecutor(1) as pool:
            table = bmod.sweep(text, {"f": values}, outputs=["s"], executor=pool, progress=False)
        assert list(table.s) == [float(v) for v in values]
    with pytest.raises(bmod.DataError, match="%ff%"):
        bmod.sweep(text, {"ff": [1, 2]}, progress=False)


def test_data_that_have_changed(tmp_path, monkeypatch):
    (tmp_path / "m.blk").write_text("set i / a /; parameter p(i); scalar s;\nexecute_load 'd.csv' p;\ns = %f%*sum(i, p(i));\n")
    monkeypatch.chdir(tmp_path)
    for value in (1, 10, 1):
        (tmp_path / "d.csv").write_text(f"i,value\na,{value}\n")
        with futures.ThreadPoolExecutor(1) as pool:
            table = bmod.sweep("m.blk", {"f": [8]}, outputs=["s"], out="r", executor=pool, progress=False)
        assert list(table.s) == [8 * value] and "reads" not in table


def test_a_model_with_its_data(tmp_path):
    """A model goes with its defines, files and data; what the grid gives stands in their place."""
    text = "$include part.inc\nset i; parameter p(i); scalar s, k / 1 /;\ns = %f%*k*sum(i, p(i));\n"
    m = bmod.Model(text, files={"part.inc": "* nothing"}, define={"f": 2}, data={"i": ["a", "b"], "p": {"a": 1, "b": 10}})
    with futures.ThreadPoolExecutor(2) as pool:
        table = bmod.sweep(m, {"k": [1, 3]}, outputs=["s"], executor=pool, out=tmp_path, progress=False)
        assert list(table.s) == [22, 66]
        table = bmod.sweep(m, {"f": [3]}, outputs=["s"], executor=pool, progress=False)
    assert list(table.s) == [33] and m.run()["s"] == 22
    assert list(table) == ["f", "s", "run", "stopped", "messages"]
    m["p"] = {"a": 5}
    table = bmod.sweep(m, {"k": [1]}, outputs=["s"], jobs=1, out=tmp_path, progress=False)
    assert list(table.s) == [10]
