"""A model: its text, and data given by name."""

from __future__ import annotations

import logging
import os
import warnings
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, Optional, Tuple, Union

from . import _bmod, _data
from ._errors import (
    AbortError,
    CompilationError,
    DataError,
    Diagnostic,
    ExecutionError,
    InterruptedWarning,
    ModelWarning,
    UnknownSymbolError,
    _limit,
)
from ._formulas import Formulas
from ._result import Result, Symbol, head_of, value_of

PathLike = Union[str, "os.PathLike[str]"]

#: Says how each solve ended (INFO), and what the solvers are doing (DEBUG).
logger = logging.getLogger("bmod")


class Model:
    """A model: a text, the files it includes, data from outside.

    >>> m = Model.from_text("set i / a, b /; parameter p(i) / a 1, b 2 /; scalar s; s = sum(i, p(i));")
    >>> m["p"] = {"a": 10, "b": 20}
    >>> m.run()["s"]
    30.0

    Data given by ``m[name] = …`` stand in place of what data statements of the text say; assignments of the text
    are carried out all the same. Each run starts from the text; a linear program starts at the basis where
    its last solve ended. Models can be copied and pickled (one from a file by its path).
    """

    #: The file, or the name and the text.
    _source: Tuple[str, ...]
    _model: _bmod.Model
    #: What was done to it since, by name, for copies in other processes.
    _define: Dict[str, str]
    _files: Dict[str, bytes]
    _folders: List[str]
    _given: Dict[str, Tuple[Any, ...]]
    #: What the text declares, and the same with the data as they are now.
    _declared: Optional[Result]
    _known: Optional[Result]

    def __init__(self, text: str, **keywords: Any):
        """The same as :meth:`from_text`."""
        made = Model.from_text(text, **keywords)
        self.__dict__.update(made.__dict__)

    @classmethod
    def _new(cls, source: Tuple[str, ...]) -> "Model":
        model = cls.__new__(cls)
        model._source = source
        model._model = _bmod.Model.from_file(*source) if len(source) == 1 else _bmod.Model.from_text(*source)
        model._define, model._files, model._folders, model._given = {}, {}, [], {}
        model._declared = model._known = None
        return model

    @classmethod
    def from_file(
        cls,
        path: PathLike,
        *,
        define: Optional[Mapping[str, Any]] = None,
        data: Optional[Mapping[str, Any]] = None,
        allow_read: Iterable[PathLike] = (),
    ) -> "Model":
        """A model in a file; what it includes is read from its folder, the current one, and `allow_read`.

        `define` sets ``%name%``, as ``bmod run -D name=value`` does; `data` gives symbols their data (:meth:`update`).
        """
        model = cls._new((os.fspath(path),))
        for folder in allow_read:
            model._allow(os.fspath(folder))
        return model._with(define, data)

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        name: str = "model.blk",
        define: Optional[Mapping[str, Any]] = None,
        data: Optional[Mapping[str, Any]] = None,
        files: Optional[Mapping[str, Union[str, bytes]]] = None,
    ) -> "Model":
        """A model from its text. `files` are those that it may include or load: names, and texts or bytes."""
        if not isinstance(text, str):
            raise TypeError(f"a model's text is a str, not {type(text).__name__}; `from_file` reads a file")
        model = cls._new((name, text))
        for file, content in (files or {}).items():
            model._file(file, content.encode() if isinstance(content, str) else content)
        return model._with(define, data)

    def _with(self, define: Optional[Mapping[str, Any]], data: Optional[Mapping[str, Any]]) -> "Model":
        for name, value in (define or {}).items():
            self.define(name, value)
        self.update(data or {})
        return self

    def _file(self, name: str, content: bytes) -> None:
        self._files[name] = content
        self._model.file(name, content)

    def _allow(self, folder: str) -> None:
        self._folders.append(folder)
        self._model.allow_read(folder)

    def copy(self) -> "Model":
        """Another model with the same text and data."""
        other = self.__class__.__new__(self.__class__)
        other.__dict__.update(self.__dict__)
        for name in ("_define", "_files", "_given"):
            setattr(other, name, dict(getattr(self, name)))
        other._folders = list(self._folders)
        other._model = self._model.copy()
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> "Model":
        return self.copy()

    def __reduce__(self) -> Any:
        return _rebuild, (self._source, self._define, self._files, self._folders, self._given)

    def define(self, name: str, value: Any) -> None:
        """Sets ``%name%`` in the text."""
        self._define[name] = str(value)
        self._model.define(name, str(value))
        self._declared = self._known = None

    @property
    def name(self) -> str:
        """The model's file, or the name it was given."""
        return self._model.name()

    def _check(self) -> Result:
        """What the text declares; data may have changed since."""
        if self._declared is None or not self._declared.ok:
            self._declared = self._with_data()
        return self._declared

    def _with_data(self) -> Result:
        """The same with the data as they are now."""
        if self._known is None:
            self._known = Result(self._model.check(), False)
        return self._known

    @property
    def symbols(self) -> Dict[str, Symbol]:
        """What the text declares: name, kind, index sets, text."""
        return self._check().symbols

    def check(self) -> List[Diagnostic]:
        """Everything that is wrong with the text and the data, without running the model."""
        return self._with_data().diagnostics

    def _symbol(self, name: str) -> Optional[Symbol]:
        if not isinstance(name, str):
            raise UnknownSymbolError(f"a symbol's name is a str, not {name!r}")
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
        xarray. Sets take a list of labels (tuples of labels), or a dict with their texts; a Series of labels whose index only
        counts, or one whose index has the labels and whose values are texts, or tell which are members (booleans).

        While a run is under way, in a callback or another thread, they are for the next run.

        :raises DataError: data that the symbol cannot take; the message names it.
        :raises UnknownSymbolError: the model has no such symbol.
        """
        symbol = self._symbol(name)
        if symbol is not None and symbol.kind not in ("set", "parameter"):
            raise DataError(f"`{name}` is a {symbol.kind}; data are given to sets and parameters")
        domain = None if symbol is None else symbol.domain
        is_set = symbol.kind == "set" if symbol else not _data.looks_like_values(data)
        try:
            if is_set:
                keys, texts = _data.members(name, data, None if domain is None else len(domain))
                self._give(name, "set_members", [k[0] for k in keys], [k[1] for k in keys], texts)
            else:
                keys, values = _data.parameter(name, data, domain, self._members)
                self._give(name, "set_values", [k[0] for k in keys], [k[1] for k in keys], values)
        except (DataError, ValueError, TypeError, OverflowError) as e:
            text = str(e)
            raise DataError(text if f"`{name}`" in text else f"`{name}`: {text}") from None

    def _give(self, name: str, method: str, *columns: Any) -> None:
        getattr(self._model, method)(name, *columns)
        self._given[name.lower()] = (name, method, *columns)
        self._known = None

    def update(self, data: Mapping[str, Any]) -> None:
        """Gives several symbols their data, in the order of the mapping: sets before what is indexed by them."""
        for name, value in data.items():
            self[name] = value

    def __getitem__(self, name: str) -> Any:
        """The data of a set or parameter before the run: given from outside, or those of the text."""
        symbol = self._symbol(name)
        if symbol is not None and symbol.kind not in ("set", "parameter"):
            raise DataError(f"`{name}` is a {symbol.kind}; it has values after a run: `m.run()[{name!r}]`")
        return self._with_data()[name]

    def __delitem__(self, name: str) -> None:
        """Takes back the data given for a symbol: the text's own count again."""
        self._symbol(name)
        self._model.forget(name)
        self._given.pop(name.lower(), None)
        self._known = None

    def __contains__(self, name: object) -> bool:
        return name in self._check()

    def __iter__(self) -> Iterator[str]:
        return iter(self.symbols)

    def _members(self, name: str) -> List[str]:
        """A set's labels in the model's order, which is where each came up first.

        :raises DataError: the set was given in another order, in which an array may be meant.
        """
        known = self._with_data()
        labels = [str(label) for label in known[name]]
        given = self._given.get((known.symbol(name).alias_of or name).lower())
        if given is not None:
            (there,), (codes,) = given[2:4]
            order = [there[code] for code in memoryview(codes).cast("i")]
            # The first writing of a label is kept: capitals and blanks behind it make no other label.
            if [label.rstrip().lower() for label in order] != [label.rstrip().lower() for label in labels]:
                shown = ", ".join(order[:3]), ", ".join(labels[:3])
                raise DataError(
                    f"`{name}` was given in the order {shown[0]}, …; the model, where labels that come up earlier "
                    f"stand first, has it as {shown[1]}, …; instead of an array give a dict or a Series"
                )
        return labels

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
        progress: bool = False,
        check: bool = True,
    ) -> Result:
        """Runs the model: its assignments, solves, displays and figures.

        :param time_limit: seconds; a solve that it stops keeps the best point it has seen.
        :param max_memory: bytes that the process may hold.
        :param options: of the language or a solver, as ``bmod run --option name=value`` sets them.
        :param certify: computes a proved interval for each optimal value (``solve.bounds``).
        :param explain: explains how each solve ended (``result.why()``).
        :param on_print: gets what the model prints, while it runs.
        :param on_progress: gets a message and the seconds so far, a few times a second.
        :param progress: shows them in a line, in a notebook with a bar.
        :param check: raises an exception if the model does not compile, or its run ends with an error.
        :raises CompilationError, ExecutionError, AbortError: with all diagnostics and their places.

        Other threads of Python run meanwhile, and callbacks may give the model data for its next run. Ctrl-C stops the run; the result has the best point found, and
        ``result.stopped`` is true. The logger ``bmod`` gets a line per solve.
        """
        _limit(time_limit)
        given = [(k, value_of(v)) for k, v in (options or {}).items()]
        line = None
        if progress and on_progress is None:
            from ._progress import Line

            on_progress = line = Line(time_limit)
        elif on_progress is None and logger.isEnabledFor(logging.DEBUG):
            on_progress = _log_progress
        try:
            raw, interrupted = self._model.run(
                given, time_limit, max_memory, certify, explain, on_print, on_progress
            )
        finally:
            if line is not None:
                line.close()
        result = Result(raw, interrupted)
        if logger.isEnabledFor(logging.INFO):
            for s in result.solves:
                logger.info("%s: %s (%s, %.3f s)", self.name, head_of(s), s.solver, s.seconds)
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

    def digest(self, outputs: Iterable[str] = (), **keywords: Any) -> str:
        """A text that is the same for the same run: texts, data, defines, options, version of bmod, and `outputs`.

        :param keywords: of :meth:`run`: those that a result may depend on.
        """
        given = [(k, value_of(v)) for k, v in (keywords.get("options") or {}).items()]
        limits = keywords.get("time_limit"), keywords.get("max_memory")
        flags = bool(keywords.get("certify")), bool(keywords.get("explain"))
        return self._model.digest(given, *limits, *flags, list(outputs))

    def show(self, model: Optional[str] = None) -> Formulas:
        """The model as formulas: sets, data, objective, equations. A notebook shows them; ``print`` writes them as text.

        :param model: which model of the text; without it the one that is solved last.
        """
        return Formulas._new(self._model.show, model, None, False)

    def dual(self, model: Optional[str] = None, *, solve: Optional[int] = None, check: bool = False) -> Formulas:
        """The dual of a linear model as formulas, with its indices. ``m.dual().model()`` runs.

        :param model: which model of the text; without it the one that is solved last.
        :param solve: which solve of the run, counted from 1.
        :param check: generates it and compares it entry by entry (``formulas.remarks``).
        """
        return Formulas._new(self._model.dual, model, solve, check)

    def kkt(self, model: Optional[str] = None, *, solve: Optional[int] = None, check: bool = False) -> Formulas:
        """The optimality conditions (Karush, Kuhn, Tucker) of a smooth model as formulas; parameters as for :meth:`dual`."""
        return Formulas._new(self._model.kkt, model, solve, check)

    def __repr__(self) -> str:
        return f"<bmod.Model {self.name!r}>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Dict[str, Any]:
        from ._errors import ModelError

        try:
            return {**self.show()._repr_mimebundle_(), "text/plain": repr(self)}
        except ModelError:
            return {"text/plain": repr(self), "text/html": self._repr_html_()}

    def _repr_html_(self) -> Optional[str]:
        from ._errors import ModelError

        try:
            return self.show()._repr_html_()
        except ModelError as e:
            import html

            return f"<pre>{html.escape(str(e))}</pre>"

    def _repr_latex_(self) -> Optional[str]:
        from ._errors import ModelError

        try:
            return self.show()._repr_latex_()
        except ModelError:
            return None


def _log_progress(message: str, seconds: float) -> None:
    logger.debug("%s (%.1f s)", message, seconds)


def _rebuild(
    source: Tuple[str, ...],
    define: Dict[str, str],
    files: Dict[str, bytes],
    folders: List[str],
    given: Dict[str, Tuple[Any, ...]],
) -> Model:
    model = Model._new(source)
    for name, content in files.items():
        model._file(name, content)
    for folder in folders:
        model._allow(folder)
    for name, value in define.items():
        model.define(name, value)
    for columns in given.values():
        model._give(*columns)
    return model
