"""Sweeps: rows, resuming, failures."""

import concurrent.futures as futures

import pytest

import bmod

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
        before = {f.name: f.stat().st_mtime_ns for f in (tmp_path / "r").iterdir()}
        again = bmod.sweep(MODEL, grid, executor=pool, out=tmp_path / "r", outputs=["x"], progress=False)
        assert before == {f.name: f.stat().st_mtime_ns for f in (tmp_path / "r").iterdir()}
    assert again.drop(columns="seconds").equals(table.drop(columns="seconds"))


def test_processes():
    table = bmod.sweep(MODEL, {"price": [3.0, 4.0]}, executor=None, progress=False)
    assert list(table.objective) == [3, 4]
