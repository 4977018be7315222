"""What came of a run: statuses, data as pandas objects, figures."""

from __future__ import annotations

import enum
import html
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional, Tuple, Union

from . import _bmod, _data
from ._errors import Diagnostic, UnknownSymbolError

if TYPE_CHECKING:
    import pandas as pd


class ModelStatus(enum.IntEnum):
    """What the point of a solve proves, with GAMS's numbers."""

    OPTIMAL = 1
    LOCALLY_OPTIMAL = 2
    UNBOUNDED = 3
    INFEASIBLE = 4
    LOCALLY_INFEASIBLE = 5
    INTERMEDIATE_INFEASIBLE = 6
    FEASIBLE = 7
    INTEGER_SOLUTION = 8
    INTERMEDIATE_NON_INTEGER = 9
    INTEGER_INFEASIBLE = 10
    LICENSE_PROBLEM = 11
    ERROR_UNKNOWN = 12
    ERROR_NO_SOLUTION = 13
    NO_SOLUTION = 14
    SOLVED_UNIQUE = 15
    SOLVED = 16
    SOLVED_SINGULAR = 17
    UNBOUNDED_NO_SOLUTION = 18
    INFEASIBLE_NO_SOLUTION = 19

    @property
    def is_solved(self) -> bool:
        """Whether the point is a solution: optimal, locally optimal, or of a square system."""
        return self in (1, 2, 8, 15, 16, 17)


class SolverStatus(enum.IntEnum):
    """How a solver ended, with GAMS's numbers."""

    NORMAL = 1
    ITERATION_LIMIT = 2
    TIME_LIMIT = 3
    SOLVER_INTERRUPT = 4
    EVALUATION_LIMIT = 5
    CAPABILITY = 6
    LICENSE = 7
    USER_INTERRUPT = 8
    SETUP_ERROR = 9
    SOLVER_ERROR = 10
    INTERNAL_ERROR = 11
    SKIPPED = 12
    SYSTEM_ERROR = 13


@dataclass(frozen=True)
class Residuals:
    """Largest violations on the model as written; none where one does not apply."""

    primal: Optional[float]
    dual: Optional[float]
    complementarity: Optional[float]
    natural: Optional[float]


@dataclass(frozen=True)
class Solve:
    """One solve of a run."""

    model: str
    using: str
    sense: Optional[str]
    solver: str
    status: ModelStatus
    solver_status: SolverStatus
    objective_variable: Optional[str]
    objective: Optional[float]
    bounds: Optional[Tuple[float, float]]
    rows: int
    columns: int
    nonzeros: int
    nonlinear_nonzeros: int
    iterations: int
    seconds: float
    residuals: Residuals
    stationarity: Optional[str]
    message: Optional[str]
    explanation: Tuple[str, ...]

    @classmethod
    def _new(cls, raw: Dict[str, Any]) -> "Solve":
        raw = dict(raw)
        return cls(
            status=ModelStatus(raw.pop("model_status")),
            solver_status=SolverStatus(raw.pop("solver_status")),
            residuals=Residuals(**raw.pop("residuals")),
            explanation=tuple(raw.pop("explanation")),
            **raw,
        )


@dataclass(frozen=True)
class Symbol:
    """What a text declares."""

    name: str
    kind: str
    domain: List[str]
    text: str
    #: For an alias, its set.
    alias_of: Optional[str] = None

    def __str__(self) -> str:
        return f"{self.name}({','.join(self.domain)})" if self.domain else self.name


class Figure:
    """A figure in SVG; a notebook shows it."""

    def __init__(self, name: str, svg: str):
        #: Name of the file.
        self.name = name
        #: The picture's text.
        self.svg = svg

    def save(self, path: Any) -> None:
        """Writes the picture to a file."""
        with open(path, "w", encoding="utf-8") as f:
            f.write(self.svg)

    def _repr_svg_(self) -> str:
        return self.svg[self.svg.find("<svg") :]

    def __repr__(self) -> str:
        return f"<bmod.Figure {self.name!r}>"


def head_of(s: Solve) -> str:
    """A solve in a line: `transport using lp: optimal, z = 153.675`."""
    objective = "" if s.objective is None else f", {s.objective_variable} = {s.objective:.10g}"
    return f"{s.model} using {s.using}: {s.status.name.lower().replace('_', ' ')}{objective}"


def value_of(v: Any) -> str:
    """An option's value as text."""
    if isinstance(v, bool):
        return "on" if v else "off"
    return str(v)


def _names(domain: List[str]) -> List[str]:
    """Names for the levels of an index: those of the sets, told apart where a set stands twice."""
    out = []
    for k, name in enumerate(domain):
        if name == "*" or domain.count(name) > 1:
            name = f"{name if name != '*' else 'label'}_{k + 1}"
        out.append(name)
    return out


class Figures(Dict[str, Figure]):
    """Figures by name: of the file, with or without `.svg`."""

    def __missing__(self, name: str) -> Figure:
        if f"{name}.svg" in self:
            return self[f"{name}.svg"]
        raise KeyError(f"no figure {name!r}; there are: {', '.join(self) or 'none'}")


class Result:
    """What came of a run.

    ``result["x"]`` is a DataFrame with the columns level, marginal, lower and upper for a variable or equation with
    indices, a Series of these for one without; a Series (a number) for a parameter; an index for a set.
    """

    def __init__(self, run: Union[_bmod.Run, "_Saved"], interrupted: bool):
        self._run = run
        self._solves: Optional[List[Solve]] = None
        self._symbols: Optional[Dict[str, Symbol]] = None
        #: Whether Ctrl-C stopped it.
        self.interrupted = interrupted

    @property
    def ok(self) -> bool:
        """Whether the model compiled and ran without errors."""
        return self._run.status == "ok"

    @property
    def stopped(self) -> bool:
        """Whether Ctrl-C or a limit ended the run early."""
        return self.interrupted or self._run.stopped

    @property
    def solves(self) -> List[Solve]:
        """The solves, in order."""
        if self._solves is None:
            self._solves = [Solve._new(s) for s in self._run.solves()]
        return self._solves

    @property
    def _last(self) -> Solve:
        if not self.solves:
            raise AttributeError("the model has solved nothing")
        return self.solves[-1]

    @property
    def status(self) -> ModelStatus:
        """Status of the last solve."""
        return self._last.status

    @property
    def objective(self) -> Optional[float]:
        """Objective value of the last solve."""
        return self._last.objective

    @property
    def residuals(self) -> Residuals:
        """Largest violations at the point of the last solve."""
        return self._last.residuals

    @property
    def diagnostics(self) -> List[Diagnostic]:
        """Errors and warnings, in order."""
        return [Diagnostic._new(d) for d in self._run.diagnostics()]

    @property
    def messages(self) -> str:
        """The diagnostics as text, with the lines of the source."""
        return self._run.messages

    @property
    def printed(self) -> str:
        """What the model printed: displays, summaries of solves."""
        return self._run.printed

    @property
    def files(self) -> Dict[str, bytes]:
        """The files that the model wrote; none is on disk. :meth:`save` writes them."""
        return dict(self._run.files())

    def save(self, folder: Any) -> None:
        """Writes the model's files into a folder."""
        import pathlib

        for name, content in self._run.files():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)

    @property
    def figures(self) -> Figures:
        """The figures that the model drew, by name."""
        return Figures((n, Figure(n, svg)) for n, svg in self._run.figures())

    @property
    def symbols(self) -> Dict[str, Symbol]:
        """What the model declares, in order."""
        return {s.name: s for s in self._by_name.values()}

    @property
    def _by_name(self) -> Dict[str, Symbol]:
        if self._symbols is None:
            self._symbols = {s[0].lower(): Symbol(*s) for s in self._run.symbols()}
        return self._symbols

    def symbol(self, name: str) -> Symbol:
        """A symbol, by its name in any case."""
        if isinstance(name, str) and name.lower() in self._by_name:
            return self._by_name[name.lower()]
        import difflib

        near = difflib.get_close_matches(str(name), list(self.symbols), 1)
        hint = f"; did you mean `{near[0]}`?" if near else ""
        raise UnknownSymbolError(f"the model has no symbol `{name}`{hint}")

    def __getitem__(self, name: str) -> Any:
        import numpy as np
        import pandas as pd

        symbol = self.symbol(name)
        if symbol.kind not in ("set", "parameter", "variable", "equation"):
            raise UnknownSymbolError(f"`{name}` is a {symbol.kind}; it has no values")
        keys, columns, texts = self._run.records(symbol.name)
        # Views of the columns, without a copy.
        values = {n: np.frombuffer(b, dtype=np.float64) for n, b in columns}
        if not keys:
            if symbol.kind == "parameter":
                return float(values["value"][0])
            return pd.Series({n: float(v[0]) for n, v in values.items()}, name=symbol.name)
        names = [symbol.name] if symbol.kind == "set" and symbol.domain == ["*"] else _names(symbol.domain)
        index = _data.index(keys, names)
        if texts is not None:
            return index
        if symbol.kind == "parameter":
            return pd.Series(values["value"], index=index, name=symbol.name, copy=False)
        return pd.DataFrame(values, index=index, copy=False)

    def full(self, name: str) -> Any:
        """The same with a record for every combination of members of the symbol's sets: levels, marginals and values that are
        not stored are 0.

        ``result[name]`` has only what is stored: a level of 0 with a marginal of 0 and the usual bounds is not.
        """
        import pandas as pd

        symbol, data = self.symbol(name), self[name]
        if not symbol.domain or symbol.kind == "set":
            return data
        if "*" in symbol.domain:
            raise ValueError(f"`{name}` is indexed by any labels; there is no end of combinations")
        sets = [self[s] for s in symbol.domain]
        index = pd.MultiIndex.from_product(sets, names=data.index.names) if len(sets) > 1 else sets[0]
        filled = data.reindex(index.rename(data.index.names))
        if symbol.kind == "parameter":
            return filled.fillna(0.0)
        defaults = dict(zip(("level", "marginal", "lower", "upper"), self._run.defaults(symbol.name)))
        missing = filled.isna().all(axis=1)
        for column, value in defaults.items():
            filled.loc[missing, column] = value
        return filled

    def texts(self, name: str) -> "pd.Series[str]":
        """The explanatory texts of a set's members."""
        import pandas as pd

        _, _, texts = self._run.records(self.symbol(name).name)
        return pd.Series(texts, index=self[name], name=name, dtype=object)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name.lower() in self._by_name

    def __iter__(self) -> Iterator[str]:
        return iter(self.symbols)

    def why(self) -> str:
        """Why each solve ended as it did; needs ``run(explain=True)``."""
        return "\n\n".join("\n".join(s.explanation) for s in self.solves if s.explanation)

    def __reduce__(self) -> Any:
        return Result, (_Saved(self._run), self.interrupted)

    def to_json(self) -> str:
        """The report of ``bmod run --json``."""
        return self._run.to_json()

    def __repr__(self) -> str:
        if not self.solves:
            return f"<bmod.Result {self._run.status}, no solves>"
        return f"<bmod.Result {head_of(self._last)}>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Dict[str, Any]:
        return {"text/plain": repr(self), "text/html": self._repr_html_()}

    def _repr_html_(self) -> str:
        head = "<tr><th>model</th><th>status</th><th>objective</th><th>rows × columns</th><th>solver</th><th>seconds</th></tr>"
        rows = "".join(
            f"<tr><td>{html.escape(s.model)} using {s.using}</td><td>{s.status.name.lower().replace('_', ' ')}</td>"
            f"<td>{'' if s.objective is None else f'{s.objective:.10g}'}</td><td>{s.rows} × {s.columns}</td>"
            f"<td>{html.escape(s.solver)}</td><td>{s.seconds:.3f}</td></tr>"
            for s in self.solves
        )
        messages = f"<pre>{html.escape(self.messages)}</pre>" if self.messages else ""
        table = f"<table>{head}{rows}</table>" if rows else ""
        figures = "".join(f"<div>{f._repr_svg_()}</div>" for f in self.figures.values())
        return messages + table + figures


class _Saved:
    """A run that came from another process: all that it has."""

    def __init__(self, run: Any):
        self.status, self.stopped = run.status, run.stopped
        self.messages, self.printed = run.messages, run.printed
        names = [s[0] for s in run.symbols() if s[1] in ("set", "parameter", "variable", "equation")]
        self._methods: Dict[str, Any] = {
            m: getattr(run, m)() for m in ("symbols", "files", "figures", "solves", "diagnostics", "to_json")
        }
        self._records = {n: run.records(n) for n in names}
        kinds = {s[0]: s[1] for s in run.symbols()}
        self._defaults = {n: run.defaults(n) for n in names if kinds[n] in ("variable", "equation")}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._methods:
            raise AttributeError(name)
        return lambda: self._methods[name]

    def records(self, name: str) -> Any:
        return self._records[name]

    def defaults(self, name: str) -> Any:
        return self._defaults[name]
