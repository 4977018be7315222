"""Models as formulas: what ``show``, ``dual`` and ``kkt`` give."""

from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Tuple

from ._errors import CompilationError, Diagnostic, ModelError


class Formulas:
    """Formulas, which a notebook shows; ``print`` writes them as text."""

    def __init__(self, raw: Dict[str, Any]):
        #: What is shown, in a few words.
        self.title: str = raw["title"]
        #: As text, at most 100 characters wide.
        self.text: str = raw["text"]
        #: As a document of LaTeX (with amsmath).
        self.latex: str = raw["latex"]
        #: As a page with MathML.
        self.html: str = raw["html"]
        #: Sentences beside the formulas: what was derived by instance, what a comparison found.
        self.remarks: List[str] = raw["remarks"]
        #: Whether the comparison that ``check=True`` asked for found no difference; none without it.
        self.passed: Optional[bool] = raw["passed"]
        #: The dual, or the optimality conditions, as a text that runs; none of ``show``.
        self.source: Optional[str] = raw["source"]
        self._body: str = raw["body"]

    @classmethod
    def _new(
        cls,
        made: Callable[..., Tuple[Optional[Dict[str, Any]], str, List[Dict[str, Any]]]],
        model: Optional[str],
        solve: Optional[int],
        check: bool,
    ) -> "Formulas":
        raw, message, diagnostics = made(model, solve, check)
        if raw is None:
            found = [Diagnostic._new(d) for d in diagnostics]
            # Codes from E0400 on are those of runs.
            compiled = all(d.code >= "E04" for d in found if d.severity == "error")
            raise (ModelError if compiled else CompilationError)(message, found)
        return cls(raw)

    def model(self) -> Any:
        """The dual, or the optimality conditions, as a model that runs."""
        from ._model import Model

        if self.source is None:
            raise ValueError("these formulas are the model itself")
        return Model.from_text(self.source, name="derived.blk")

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<bmod.Formulas {self.title!r}>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Dict[str, Any]:
        return {"text/plain": self.text, "text/html": self._repr_html_(), "text/latex": self._repr_latex_()}

    def _repr_html_(self) -> str:
        notes = "".join(f"<p>{note}</p>" for note in self.remarks)
        return self._body + notes

    def _repr_latex_(self) -> str:
        # A notebook has its own document around it.
        _, _, body = self.latex.partition(r"\begin{document}")
        return body.partition(r"\end{document}")[0].strip() or self.latex
