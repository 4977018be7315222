"""bmod from Python: models in the GAMS tradition, data and answers as pandas objects.

>>> import bmod
>>> m = bmod.Model.from_text('''
...     Set i / a, b /;  Parameter price(i) / a 3, b 5 /;  Scalar room / 6 /;
...     Positive variable x(i);  Variable z;
...     Equations value, most(i), total;
...     value..  z =e= sum(i, price(i)*x(i));
...     most(i)..  x(i) =l= 4;
...     total..  sum(i, x(i)) =l= room;
...     Model shop / all /;  solve shop using lp maximizing z;''')
>>> m["room"] = 5
>>> r = m.run()
>>> r.status, r.objective
(<ModelStatus.OPTIMAL: 1>, 23.0)
>>> r["x"].level["b"]
4.0
"""

from typing import TYPE_CHECKING, Any

from . import _bmod
from ._errors import (
    AbortError,
    CompilationError,
    DataError,
    Diagnostic,
    Error,
    ExecutionError,
    InterruptedWarning,
    ModelError,
    ModelWarning,
    Place,
    UnknownSymbolError,
)
from ._formulas import Formulas
from ._model import Model
from ._result import Figure, ModelStatus, Residuals, Result, Solve, SolverStatus, Symbol

if TYPE_CHECKING:
    from ._sweep import sweep

__version__ = _bmod.__version__

__all__ = [
    "AbortError",
    "CompilationError",
    "DataError",
    "Diagnostic",
    "Error",
    "ExecutionError",
    "Figure",
    "Formulas",
    "InterruptedWarning",
    "Model",
    "ModelError",
    "ModelStatus",
    "ModelWarning",
    "Place",
    "Residuals",
    "Result",
    "Solve",
    "SolverStatus",
    "Symbol",
    "UnknownSymbolError",
    "sweep",
]


def __getattr__(name: str) -> Any:
    # What few programs need is loaded when it is asked for.
    if name == "sweep":
        from ._sweep import sweep

        return sweep
    raise AttributeError(f"module 'bmod' has no attribute {name!r}")


def load_ipython_extension(shell: Any) -> None:
    """``%load_ext bmod``: the cell magic ``%%bmod``."""
    from ._magic import register

    register(shell)


def main() -> int:
    """The command line ``bmod``."""
    import sys

    return _bmod.main(sys.argv)
