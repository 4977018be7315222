"""Many runs of a model, on the cores of one machine or by any executor on a cluster."""

from __future__ import annotations

import concurrent.futures as futures
import hashlib
import itertools
import json
import os
import pathlib
import tempfile
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Union

if TYPE_CHECKING:
    import pandas as pd

Grid = Union[Mapping[str, Sequence[Any]], Iterable[Mapping[str, Any]]]

#: Rows of a Parquet file of results, which are collected while they come.
ROWS_PER_PART = 200


def points_of(grid: Grid) -> List[Dict[str, Any]]:
    """All combinations of a mapping from names to values; a list of points as it is."""
    if isinstance(grid, Mapping):
        names = list(grid)
        return [dict(zip(names, values)) for values in itertools.product(*grid.values())]
    return [dict(point) for point in grid]


def key_of(text: str, point: Mapping[str, Any], how: Mapping[str, Any]) -> str:
    """What a run depends on, as a short text: the model, the point, the options, the version."""
    from . import __version__

    content = json.dumps([__version__, text, point, how], sort_keys=True, default=repr)
    return hashlib.sha256(content.encode()).hexdigest()[:24]


def run_one(
    path: Optional[str],
    text: Optional[str],
    data: Mapping[str, Any],
    point: Mapping[str, Any],
    outputs: Sequence[str],
    keywords: Mapping[str, Any],
) -> Dict[str, Any]:
    """One run as a row. A point gives defines (``%name%``) and data of symbols by the same names."""
    import warnings

    from . import Error, Model

    row: Dict[str, Any] = {}
    try:
        define = {k: v for k, v in point.items() if isinstance(v, (str, int, float, bool))}
        model = Model.from_file(path, define=define) if path else Model.from_text(text or "", define=define)
        declared = {s.lower(): s for s in model.symbols}
        for name, value in {**data, **point}.items():
            symbol = declared.get(name.lower())
            if symbol is not None and model.symbols[symbol].kind in ("set", "parameter"):
                model[name] = value
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = model.run(check=False, **keywords)
        row["run"] = result._run.status
        row["messages"] = result.messages
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
        if result.ok:
            for name in outputs:
                value = result[name]
                if hasattr(value, "level") and not hasattr(value, "columns"):
                    row[name] = float(value.level)
                elif isinstance(value, float):
                    row[name] = value
                else:
                    column = value.level if hasattr(value, "columns") else value
                    for label, v in column.items():
                        labels = label if isinstance(label, tuple) else (label,)
                        row[f"{name}[{','.join(map(str, labels))}]"] = float(v)
        row["stopped"] = result.stopped
    except (Error, OSError, ValueError) as e:
        row.update(run="error", messages=str(e))
    return row


class _Store:
    """Rows in a folder of Parquet files; each is written whole. What is there is not run again."""

    def __init__(self, out: Optional[Any]):
        self.rows: List[Dict[str, Any]] = []
        self.pending: List[Dict[str, Any]] = []
        self.folder = None if out is None else pathlib.Path(out)
        if self.folder is not None:
            import pyarrow.parquet as parquet

            self.folder.mkdir(parents=True, exist_ok=True)
            for file in sorted(self.folder.glob("part-*.parquet")):
                self.rows += parquet.read_table(file).to_pylist()

    def known(self) -> Dict[str, Dict[str, Any]]:
        return {r["key"]: r for r in self.rows}

    def add(self, row: Dict[str, Any]) -> None:
        self.rows.append(row)
        self.pending.append(row)
        if len(self.pending) >= ROWS_PER_PART:
            self.flush()

    def flush(self) -> None:
        if self.folder is None or not self.pending:
            self.pending = []
            return
        import pyarrow
        import pyarrow.parquet as parquet

        names = dict.fromkeys(n for row in self.pending for n in row)
        table = pyarrow.Table.from_pylist([{n: r.get(n) for n in names} for r in self.pending])
        number = len(list(self.folder.glob("part-*.parquet")))
        handle, draft = tempfile.mkstemp(dir=self.folder, prefix=".part-")
        os.close(handle)
        parquet.write_table(table, draft)
        os.replace(draft, self.folder / f"part-{number:05d}.parquet")
        self.pending = []


def sweep(
    model: Any,
    grid: Grid,
    *,
    data: Optional[Mapping[str, Any]] = None,
    outputs: Sequence[str] = (),
    executor: Optional[futures.Executor] = None,
    out: Optional[Any] = None,
    progress: Optional[bool] = None,
    key: Callable[..., str] = key_of,
    **keywords: Any,
) -> "pd.DataFrame":
    """Runs a model for every point of a grid; a table with a row per point, in the order of the grid.

    :param model: a file, or a text that has more than one line.
    :param grid: a mapping from names to values (all combinations are run), or a list of mappings. A name is a define
        (``%name%``), or a set or parameter of the model, or both.
    :param data: data of symbols that are the same in all runs.
    :param outputs: parameters and variables whose values become columns, ``x[a,b]`` for one with indices.
    :param executor: any :class:`concurrent.futures.Executor`; none: a process per core of this machine. Those of
        Dask (``client.get_executor()``), Ray and MPI (``mpi4py.futures``) take the runs to a cluster.
    :param out: a folder for the rows as Parquet files, written while they come. Runs that are there are not repeated.
    :param progress: whether tqdm shows a bar; by default if it is installed.
    :param keywords: of :meth:`bmod.Model.run`: ``time_limit``, ``options`` …

    A run that fails is a row with `run` and `messages`.
    """
    import pandas as pd

    source = os.fspath(model)
    is_text = "\n" in source
    content = source if is_text else pathlib.Path(source).read_text(encoding="utf-8")
    how = {"data": dict(data or {}), "outputs": list(outputs), "keywords": keywords}
    points = points_of(grid)
    keys = [key(content, point, how) for point in points]
    store = _Store(out)
    known = store.known()
    todo = {k: p for k, p in zip(keys, points) if k not in known}
    own = futures.ProcessPoolExecutor() if executor is None and todo else None
    runner = executor or own
    bar = _bar(len(points), len(points) - len(todo), progress)
    try:
        waiting = {
            runner.submit(
                run_one, None if is_text else source, content if is_text else None,
                dict(data or {}), point, list(outputs), keywords,
            ): k
            for k, point in todo.items()
        }
        for done in futures.as_completed(waiting):
            k = waiting[done]
            try:
                row = done.result()
            except Exception as e:  # noqa: BLE001: a worker that died is a row, whatever the executor raises
                row = {"run": "lost", "messages": f"{type(e).__name__}: {e}"}
            row = {"key": k, **todo[k], **row}
            if row["run"] == "lost":
                known[k] = row  # to be run again next time
            else:
                store.add(row)
            bar.update()
    finally:
        store.flush()
        bar.close()
        if own is not None:
            own.shutdown(cancel_futures=True)
    known.update(store.known())
    return pd.DataFrame([known[k] for k in keys]).drop(columns="key")


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
