"""How far a run is, in a line."""

from __future__ import annotations

import html
import sys
from typing import Any, Optional


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return type(shell).__name__ == "ZMQInteractiveShell"


class Line:
    """Shows the last message: in a notebook with a bar, on a terminal in one line, elsewhere not at all."""

    def __init__(self, time_limit: Optional[float], after: float = 0.5):
        self._limit = time_limit
        self._after = after
        self._handle: Any = None
        self._notebook = _in_notebook()
        self._wide = 0

    def __call__(self, message: str, seconds: float) -> None:
        if seconds < self._after:
            return
        if self._notebook:
            self._show(message, seconds)
        elif sys.stderr.isatty():
            line = f"{message} · {seconds:.0f} s"[:100]
            sys.stderr.write("\r" + line.ljust(self._wide))
            sys.stderr.flush()
            self._wide = len(line)

    def _show(self, message: str, seconds: float) -> None:
        from IPython.display import HTML, display

        value = f' value="{seconds:.1f}" max="{self._limit}"' if self._limit else ""
        shown = HTML(f"<progress{value}></progress> {html.escape(message)} · {seconds:.0f} s")
        if self._handle is None:
            self._handle = display(shown, display_id=True)
        else:
            self._handle.update(shown)

    def close(self) -> None:
        """Takes the line away."""
        if self._handle is not None:
            from IPython.display import HTML

            self._handle.update(HTML(""))
        elif self._wide:
            sys.stderr.write("\r" + " " * self._wide + "\r")
            sys.stderr.flush()
