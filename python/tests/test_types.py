"""A program with types, as a user writes it, passes ``mypy --strict`` with the installed package."""

import subprocess
import sys

import pytest

PROGRAM = '''
from __future__ import annotations

from pathlib import Path

import bmod
import pandas as pd


def study(path: Path, need: dict[str, float]) -> pd.Series[float]:
    m = bmod.Model.from_file(path, define={"friction": 0.6})
    m["need"] = need
    m.update({"price": pd.Series([1.0], index=["a"])})
    r: bmod.Result = m.run(time_limit=10, options={"lp": "simplex"}, explain=True, on_print=print)
    status: bmod.ModelStatus = r.status
    objective: float | None = r.objective
    print(status, objective, r.residuals, r.why(), r.solves[0].iterations)
    for name, figure in r.figures.items():
        print(name, figure.svg)
    formulas: bmod.Formulas = m.dual(check=True)
    print(formulas.latex, m.show().html)
    try:
        m.run()
    except bmod.CompilationError as e:
        for d in e.errors:
            if d.place is not None:
                print(d.place.line, d.place.column, d.code, d.message, d.help)
    table: pd.DataFrame = bmod.sweep(path, {"friction": [0.4, 0.5]}, outputs=["alpha"])
    print(table)
    level: pd.Series[float] = r["carry"].level
    return level
'''


def mypy(folder, program):
    (folder / "program.py").write_text(program, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "program.py"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600)


def test_a_program_with_types(tmp_path):
    pytest.importorskip("mypy")
    done = mypy(tmp_path, PROGRAM)
    assert done.returncode == 0, done.stdout + done.stderr
    # The types are there: a wrong one is found.
    wrong = mypy(tmp_path, PROGRAM.replace("objective: float | None", "objective: str"))
    assert wrong.returncode == 1 and "float" in wrong.stdout, wrong.stdout
