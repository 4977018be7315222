"""What may go wrong: exceptions with the diagnostics and their places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple


@dataclass(frozen=True)
class Place:
    """A place in a text: lines and columns from 1; the end is exclusive."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True)
class Diagnostic:
    """An error or a warning: what is wrong, where, and how to fix it."""

    code: str
    severity: str
    message: str
    label: str
    help: Optional[str]
    place: Optional[Place]
    related: Tuple[Tuple[Optional[Place], str], ...]

    @classmethod
    def _new(cls, raw: Dict[str, Any]) -> "Diagnostic":
        def place(p: Optional[Sequence[Any]]) -> Optional[Place]:
            return Place(*p) if p else None

        return cls(
            code=raw["code"],
            severity=raw["severity"],
            message=raw["message"],
            label=raw["label"],
            help=raw["help"],
            place=place(raw["place"]),
            related=tuple((place(p), text) for p, text in raw["related"]),
        )

    def __str__(self) -> str:
        where = f"{self.place}: " if self.place else ""
        return f"{where}{self.message}"


class Error(Exception):
    """Whatever bmod raises."""


class DataError(Error, ValueError):
    """Data for a symbol that cannot be taken; the message names the symbol."""


class UnknownSymbolError(Error, KeyError):
    """The model has no such symbol."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class ModelError(Error):
    """A model did not compile or did not run to its end."""

    #: Everything that was said, warnings included.
    diagnostics: List[Diagnostic]
    #: What came of the run until then.
    result: Any

    def __init__(self, messages: str, diagnostics: List[Diagnostic], result: Any = None):
        super().__init__("\n" + messages.rstrip() if messages else "the model failed")
        self.diagnostics = diagnostics
        self.result = result

    @property
    def errors(self) -> List[Diagnostic]:
        """The diagnostics that are errors."""
        return [d for d in self.diagnostics if d.severity == "error"]


class CompilationError(ModelError):
    """The text has errors, or data do not fit its sets; nothing was run."""


class ExecutionError(ModelError):
    """The run ended with an error."""


class AbortError(ExecutionError):
    """The model stopped itself with `abort`."""


class ModelWarning(UserWarning):
    """A warning about a model."""


class InterruptedWarning(UserWarning):
    """Ctrl-C stopped a run; the result has the best point found."""


def _limit(seconds: Optional[float]) -> None:
    """Refuses a time limit that is none."""
    if seconds is not None and not 0 < float(seconds) < float("inf"):
        raise ValueError(f"time_limit is a number of seconds above 0, or None for no limit; not {seconds!r}")
