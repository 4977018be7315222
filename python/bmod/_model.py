"""A model: its text, and data given by name."""

from __future__ import annotations

import os
import warnings
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Union

from . import _bmod, _data
from ._errors import (
    AbortError,
    CompilationError,
    DataError,
    ExecutionError,
    InterruptedWarning,
    ModelWarning,
    UnknownSymbolError,
)
from ._result import Result, Symbol, value_of

PathLike = Union[str, "os.PathLike[str]"]


class Model:
    """A model: a text, the files it includes, data from outside.

    >>> m = Model.from_text("set i / a, b /; parameter p(i) / a 1, b 2 /; scalar s; s = sum(i, p(i));")
    >>> m["p"] = {"a": 10, "b": 20}
    >>> m.run()["s"]
    30.0

    Data given by ``m[name] = …`` stand in place of what data statements of the text say; assignments of the text
    are carried out all the same. Each run starts from the text.
    """

    def __init__(self, model: _bmod.Model):
        self._model = model
        self._checked: Optional[Result] = None

    @classmethod
    def from_file(
        cls,
        path: PathLike,
        *,
        define: Optional[Mapping[str, Any]] = None,
        allow_read: Iterable[PathLike] = (),
    ) -> "Model":
        """A model in a file; what it includes is read from its folder, the current one, and `allow_read`.

        `define` sets ``%name%``, as ``bmod run -D name=value`` does.
        """
        model = cls(_bmod.Model.from_file(os.fspath(path)))
        for folder in allow_read:
            model._model.allow_read(os.fspath(folder))
        return model._defined(define)

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        name: str = "model.blk",
        define: Optional[Mapping[str, Any]] = None,
        files: Optional[Mapping[str, Union[str, bytes]]] = None,
    ) -> "Model":
        """A model from its text. `files` are those that it may include or load: names, and texts or bytes."""
        model = cls(_bmod.Model.from_text(name, text))
        for file, content in (files or {}).items():
            model._model.file(file, content.encode() if isinstance(content, str) else content)
        return model._defined(define)

    def _defined(self, define: Optional[Mapping[str, Any]]) -> "Model":
        for name, value in (define or {}).items():
            self._model.define(name, str(value))
        return self

    def copy(self) -> "Model":
        """Another model with the same text and data."""
        return Model(self._model.copy())

    __copy__ = copy

    def define(self, name: str, value: Any) -> None:
        """Sets ``%name%`` in the text."""
        self._model.define(name, str(value))
        self._checked = None

    @property
    def name(self) -> str:
        """The model's file, or the name it was given."""
        return self._model.name()

    def _check(self) -> Result:
        if self._checked is None:
            self._checked = Result(self._model.check(), False)
        return self._checked

    @property
    def symbols(self) -> Dict[str, Symbol]:
        """What the text declares: name, kind, index sets, text."""
        return self._check().symbols

    def check(self) -> List[Any]:
        """Everything that is wrong with the text and the data, without running the model."""
        return self._check().diagnostics

    def _symbol(self, name: str) -> Optional[Symbol]:
        checked = self._check()
        try:
            return checked.symbol(name)
        except UnknownSymbolError:
            # A text that does not compile may lack symbols; the run says what is wrong with it.
            if not checked.ok:
                return None
            raise

    def __setitem__(self, name: str, data: Any) -> None:
        """Gives a symbol its data.

        Parameters take a number, a dict from labels (tuples of labels), a pandas Series with an index, a DataFrame
        (one column; a table; or columns of labels and `value`), a NumPy array in the order of the sets, an
        xarray. Sets take a list of labels (tuples of labels), or a dict with their texts.
        """
        symbol = self._symbol(name)
        if symbol is not None and symbol.kind not in ("set", "parameter"):
            raise DataError(f"`{name}` is a {symbol.kind}; data are given to sets and parameters")
        domain = None if symbol is None else symbol.domain
        is_set = symbol.kind == "set" if symbol else not _is_values(data)
        try:
            if is_set:
                keys, texts = _data.members(name, data, None if domain is None else len(domain))
                self._model.set_members(name, [k[0] for k in keys], [k[1] for k in keys], texts)
            else:
                keys, values = _data.parameter(name, data, domain, self._members)
                self._model.set_values(name, [k[0] for k in keys], [k[1] for k in keys], values)
        except DataError:
            raise
        except ValueError as e:
            raise DataError(str(e)) from None
        if is_set:
            # Parameters keep their shape; the members of sets are looked up again.
            self._checked = None

    def __getitem__(self, name: str) -> Any:
        """The data of a set or parameter before the run: given from outside, or those of the text."""
        self._checked = None
        return self._check()[name]

    def __delitem__(self, name: str) -> None:
        """Takes back the data given for a symbol: the text's own count again."""
        self._model.forget(name)
        self._checked = None

    def _members(self, name: str) -> List[str]:
        labels = self._check()[name]
        return [str(label) for label in labels]

    def run(
        self,
        *,
        time_limit: Optional[float] = None,
        max_memory: Optional[int] = None,
        options: Optional[Mapping[str, Any]] = None,
        certify: bool = False,
        explain: bool = False,
        on_print: Optional[Callable[[str], Any]] = None,
        on_progress: Optional[Callable[[str, float], Any]] = None,
        check: bool = True,
    ) -> Result:
        """Runs the model: its assignments, solves, displays and figures.

        :param time_limit: seconds; a solve that it stops keeps the best point it has seen.
        :param max_memory: bytes that the process may hold.
        :param options: of the language or a solver, as ``bmod run --option name=value`` sets them.
        :param certify: computes a proved interval for each optimal value.
        :param explain: explains how each solve ended (``result.why()``).
        :param on_print: gets what the model prints, while it runs.
        :param on_progress: gets a message and the seconds so far, a few times a second.
        :param check: raises an exception if the model does not compile, or its run ends with an error.
        :raises CompilationError, ExecutionError, AbortError: with all diagnostics and their places.

        Other threads of Python run meanwhile. Ctrl-C stops the run; the result has the best point found, and
        ``result.stopped`` is true.
        """
        given = [(k, value_of(v)) for k, v in (options or {}).items()]
        raw, interrupted = self._model.run(
            given, time_limit, max_memory, certify, explain, on_print, on_progress
        )
        result = Result(raw, interrupted)
        for d in result.diagnostics:
            if d.severity == "warning":
                warnings.warn(str(d), ModelWarning, stacklevel=2)
        if interrupted:
            warnings.warn("stopped by Ctrl-C; the result is what was found until then", InterruptedWarning, stacklevel=2)
        elif check and not result.ok:
            kinds = {"compilation_error": CompilationError, "aborted": AbortError}
            kind = kinds.get(raw.status, ExecutionError)
            raise kind(result.messages, result.diagnostics, result)
        return result

    #: The same: a model solves what its `solve` statements say.
    solve = run

    def __repr__(self) -> str:
        return f"<bmod.Model {self.name!r}>"


def _is_values(data: Any) -> bool:
    """Whether data look like a parameter's, for a text that does not compile."""
    if isinstance(data, Mapping):
        return all(not isinstance(v, str) for v in data.values())
    return not isinstance(data, (list, tuple, set))
