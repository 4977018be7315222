"""Many runs of a model, on the cores of one machine or by any executor on a cluster."""

from __future__ import annotations

import concurrent.futures as futures
import itertools
import json
import numbers
import os
import pathlib
import tempfile
import threading
import time
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from ._errors import _limit

if TYPE_CHECKING:
    import pandas as pd

    from ._model import Model

Grid = Union[Mapping[str, Sequence[Any]], Iterable[Mapping[str, Any]]]
#: What makes a model in another process: that of its pickle.
Source = Tuple[Any, ...]

#: Rows of a Parquet file of results, which are collected while they come, and seconds for which they wait at most.
ROWS_PER_PART = 200
SECONDS_PER_PART = 2.0


def points_of(grid: Grid) -> List[Dict[str, Any]]:
    """All combinations of a mapping from names to values; a list of points as it is."""
    if isinstance(grid, Mapping):
        names = list(grid)
        return [dict(zip(names, values)) for values in itertools.product(*grid.values())]
    return [dict(point) for point in grid]


def model_at(source: Source, data: Mapping[str, Any], point: Mapping[str, Any]) -> "Model":
    """The model at a point, which gives defines (``%name%``) and data of symbols by the same names."""
    from ._model import _rebuild

    point = {name: _plain(value) for name, value in point.items()}
    model = _rebuild(*source)
    for name, value in point.items():
        if isinstance(value, (str, numbers.Real)):
            model.define(name, value)
    symbols = {name.lower(): s for name, s in model.symbols.items()}
    for name, value in {**data, **point}.items():
        symbol = symbols.get(name.lower())
        if symbol is not None and symbol.kind in ("set", "parameter"):
            model[name] = value
        elif name in data:
            model[name] = value  # says that there is no such symbol
    return model


def _plain(value: Any) -> Any:
    """A number as ``bmod sweep -D`` has it, also one of NumPy: 1.0 is `1`."""
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
        value = value.item()
    return int(value) if isinstance(value, float) and value.is_integer() else value


def run_one(
    source: Source,
    data: Mapping[str, Any],
    point: Mapping[str, Any],
    outputs: Sequence[str],
    keywords: Mapping[str, Any],
) -> Dict[str, Any]:
    """One run as a row."""
    import warnings

    from . import Error

    row: Dict[str, Any] = {}
    try:
        model = model_at(source, data, point)
        row["key"] = model.digest(outputs, **keywords)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = model.run(check=False, **keywords)
        row["reads"] = result._run.reads
        row["run"] = result._run.status
        row["messages"] = result.messages
        row["stopped"] = result.stopped
        if result.solves:
            last = result.solves[-1]
            row.update(
                status=last.status.name.lower(),
                objective=last.objective,
                solver=last.solver,
                iterations=last.iterations,
                primal=last.residuals.primal,
                seconds=sum(s.seconds for s in result.solves),
            )
        for name in outputs if result.ok else ():
            value = result[name]
            if isinstance(value, float):
                row[name] = value
            elif value.ndim == 1 and not result.symbol(name).domain:
                row[name] = float(value.level)
            else:
                column = value.level if value.ndim == 2 else value
                for label, v in column.items():
                    labels = label if isinstance(label, tuple) else (label,)
                    row[f"{name}[{','.join(map(str, labels))}]"] = float(v)
    except (Error, OSError, ValueError) as e:
        row.update(run="error", messages=str(e))
        # Rows without a key are run again.
        row.setdefault("key", None)
    return row


class _Store:
    """Rows in a folder of Parquet files; each is written whole. What is there is not run again.

    Their names begin with `_`: those who read the folder as a table pass over such files.
    """

    def __init__(self, out: Optional[Any]):
        self.rows: List[Dict[str, Any]] = []
        self.pending: List[Dict[str, Any]] = []
        self.flushed = time.monotonic()
        self.folder = None if out is None else pathlib.Path(out)
        if self.folder is not None:
            try:
                import pyarrow.parquet as parquet
            except ImportError:
                raise ImportError("`out` keeps the rows in Parquet files, for which it needs pyarrow: pip install pyarrow") from None

            self.folder.mkdir(parents=True, exist_ok=True)
            for file in sorted(self.folder.glob("_part-*.parquet")):
                self.rows += parquet.read_table(file).to_pylist()
            # What `bmod sweep` has run.
            for file in sorted(self.folder.glob("rows-*.jsonl")):
                for line in file.read_text(encoding="utf-8").splitlines():
                    try:
                        self.rows.append(json.loads(line))
                    except ValueError:
                        pass  # half a line of a process that was killed

    def known(self) -> Dict[str, List[Dict[str, Any]]]:
        """Rows by key; of those with the same one, files that the run read may have changed since."""
        known: Dict[str, List[Dict[str, Any]]] = {}
        for row in self.rows:
            if row.get("key"):
                known.setdefault(row["key"], []).append(row)
        return known

    def add(self, row: Dict[str, Any]) -> None:
        self.rows.append(row)
        self.pending.append(row)
        if len(self.pending) >= ROWS_PER_PART or time.monotonic() - self.flushed > SECONDS_PER_PART:
            self.flush()

    def flush(self) -> None:
        self.flushed = time.monotonic()
        if self.folder is None or not self.pending:
            self.pending = []
            return
        import pyarrow

        names = dict.fromkeys(n for row in self.pending for n in row)
        table = pyarrow.Table.from_pylist([{n: r.get(n) for n in names} for r in self.pending])
        number = len(list(self.folder.glob("_part-*.parquet")))
        self._write(f"_part-{number:05d}.parquet", table)
        self.pending = []

    def end(self, table: "pd.DataFrame") -> None:
        """The whole table beside the parts, of which each has the columns of its own rows only; who reads the folder gets it alone."""
        if self.folder is not None:
            import pyarrow

            self._write("results.parquet", pyarrow.Table.from_pandas(table, preserve_index=False))

    def _write(self, name: str, table: Any) -> None:
        import pyarrow.parquet as parquet

        assert self.folder is not None
        handle, draft = tempfile.mkstemp(dir=self.folder, prefix=".part-")
        os.close(handle)
        parquet.write_table(table, draft)
        os.replace(draft, self.folder / name)


def sweep(
    model: Any,
    grid: Grid,
    *,
    data: Optional[Mapping[str, Any]] = None,
    outputs: Sequence[str] = (),
    executor: Optional[futures.Executor] = None,
    jobs: Optional[int] = None,
    out: Optional[Any] = None,
    progress: Optional[bool] = None,
    **keywords: Any,
) -> "pd.DataFrame":
    """Runs a model for every point of a grid; a table with a row per point, in the order of the grid.

    :param model: a file, a text that has more than one line, or a :class:`bmod.Model` with its defines, files and data.
    :param grid: a mapping from names to values (all combinations are run), or a list of mappings. A name is a define
        (``%name%``), or a set or parameter of the model, or both.
    :param data: data of symbols that are the same in all runs.
    :param outputs: parameters and variables whose values (levels) become columns, ``x[a,b]`` for one with indices.
    :param executor: any :class:`concurrent.futures.Executor`; none: `jobs` processes on this machine. Those of
        Dask (``client.get_executor()``) and MPI (``mpi4py.futures``) take the runs to a cluster.
    :param jobs: processes; by default one per core.
    :param out: a folder for the rows as Parquet files, written while they come, and for the table, `results.parquet`, at the end.
        Runs that are there, also those of the command ``bmod sweep``, are not repeated.
    :param progress: whether tqdm shows a bar; by default if it is installed.
    :param keywords: of :meth:`bmod.Model.run`: ``time_limit``, ``options``, ``max_memory``, ``certify``, ``explain``.

    A run that fails is a row with `run` and `messages`. If a process on this machine dies, its run is tried twice more.
    """
    import pandas as pd

    _limit(keywords.get("time_limit"))
    fixed = (_source(model), dict(data or {}))
    points = points_of(grid)
    _check_names(fixed, points)
    store = _Store(out)
    known = store.known()
    rows: Dict[int, Dict[str, Any]] = {}
    if known:
        for n, point in enumerate(points):
            found = _found(known, fixed, point, outputs, keywords)
            if found is not None:
                rows[n] = found
    bar = _bar(len(points), len(rows), progress)
    tries = 3 if executor is None else 1
    try:
        for attempt in range(tries):
            todo = [n for n in range(len(points)) if rows.get(n, _LOST)["run"] == "lost"]
            if not todo:
                break
            own = _processes(jobs) if executor is None else None
            try:
                waiting = {
                    (executor or own).submit(run_one, *fixed, points[n], list(outputs), keywords): n  # type: ignore[union-attr]
                    for n in todo
                }
                for done in futures.as_completed(waiting):
                    n = waiting[done]
                    try:
                        row = done.result()
                    except Exception as e:  # noqa: BLE001: a worker that died is a row, whatever the executor raises
                        row = {"key": None, "run": "lost", "messages": f"{type(e).__name__}: {e}"}
                    rows[n] = {**points[n], **row}
                    if row["key"]:
                        store.add(rows[n])
                    if row["run"] != "lost" or attempt + 1 == tries:
                        bar.update()
            finally:
                store.flush()
                if own is not None:
                    own.shutdown(cancel_futures=True)
    finally:
        bar.close()
    table = pd.DataFrame([{**points[n], **rows[n]} for n in range(len(points))])
    last = ["key", "reads", *_ABOUT]
    table = table[[c for c in table if c not in last] + [c for c in _ABOUT if c in table]]
    store.end(table)
    return table


#: Columns behind those of the grid and the outputs, as `bmod sweep` has them.
_ABOUT = ["run", "status", "objective", "solver", "iterations", "primal", "seconds", "stopped", "messages"]


def _source(model: Any) -> Source:
    """What makes the model anywhere: a worker may stand in another folder."""
    from . import Model

    if isinstance(model, Model):
        source, define, files, folders, given = model.__reduce__()[1]
        if len(source) == 1:
            source = (os.path.abspath(source[0]),)
        return source, define, files, [os.path.abspath(f) for f in folders], given
    text = os.fspath(model)
    if "\n" not in text and not os.path.isfile(text):
        raise FileNotFoundError(f"there is no model {text!r}")
    return ("model.blk", text) if "\n" in text else (os.path.abspath(text),), {}, {}, [], {}


def _processes(jobs: Optional[int]) -> futures.Executor:
    return futures.ProcessPoolExecutor(jobs, initializer=_end_with, initargs=(os.getpid(),))


def _end_with(parent: int) -> None:
    """Ends this process when its parent is gone: a killed sweep leaves nothing behind."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    if os.getppid() == parent:  # not with a server between them
        threading.Thread(target=watch, daemon=True).start()


#: A point that was not run.
_LOST = {"run": "lost"}


Fixed = Tuple[Source, Dict[str, Any]]


def _check_names(fixed: Fixed, points: List[Dict[str, Any]]) -> None:
    """Refuses a name that stands for nothing at any point: all runs would be the same."""
    from . import DataError, Error

    idle = {name for point in points for name in point}
    for point in points:
        if not idle:
            return
        try:
            known = model_at(*fixed, point)._with_data()
        except (Error, OSError, ValueError):
            return  # the rows say why
        if not known.ok:
            return
        symbols = {name.lower() for name, s in known.symbols.items() if s.kind in ("set", "parameter")}
        unused = set(known._run.unused_defines)
        idle = {n for n in idle if n not in point or n.lower() in unused and n.lower() not in symbols}
    if idle and points:
        name = sorted(idle)[0]
        raise DataError(f"the model asks for no `%{name}%`, and has no set or parameter of this name; all runs would be the same")


def _found(
    known: Mapping[str, List[Dict[str, Any]]], fixed: Fixed, point: Mapping[str, Any], outputs: Sequence[str], keywords: Mapping[str, Any]
) -> Optional[Dict[str, Any]]:
    """The row of a run that was made, if the files that it read are as they were."""
    from . import Error

    try:
        model = model_at(*fixed, point)
        rows = known.get(model.digest(outputs, **keywords), [])
        return next((r for r in rows if model._model.still_reads(r.get("reads") or "")), None)
    except (Error, OSError, ValueError):
        return None


class _NoBar:
    def update(self) -> None:
        pass

    def close(self) -> None:
        pass


def _bar(total: int, done: int, wanted: Optional[bool]) -> Any:
    if wanted is not False:
        try:
            from tqdm.auto import tqdm

            return tqdm(total=total, initial=done, unit="run")
        except ImportError:
            pass
    return _NoBar()
