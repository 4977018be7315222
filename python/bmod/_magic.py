"""The cell magic ``%%bmod`` of notebooks."""

from __future__ import annotations

import argparse
import html
import shlex
import warnings
from typing import Any, List

from ._errors import Diagnostic, Error
from ._model import Model
from ._result import Result


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="%%bmod", add_help=False)
    parser.add_argument("result", nargs="?", help="variable that gets the result")
    parser.add_argument("--in", dest="inputs", nargs="+", default=[], help="variables that give symbols their data")
    parser.add_argument("--out", dest="outputs", nargs="+", default=[], help="symbols that become variables")
    parser.add_argument("-D", dest="define", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--time-limit", type=float)
    parser.add_argument("--quiet", action="store_true", help="shows no displays and summaries")
    return parser


def marked(diagnostics: List[Diagnostic], text: str, name: str) -> str:
    """Diagnostics as HTML, the lines of the cell with the places underlined."""
    lines = text.split("\n")
    out = []
    for d in diagnostics:
        color = "#b00020" if d.severity == "error" else "#8a6d00"
        parts = [f'<span style="color:{color}"><b>{d.code}</b> {html.escape(d.message)}</span>']
        p = d.place
        if p and p.file == name and p.line <= len(lines):
            line = lines[p.line - 1]
            end = p.end_column - 1 if p.end_line == p.line else len(line)
            before, inside, after = line[: p.column - 1], line[p.column - 1 : end], line[end:]
            under = f'<span style="text-decoration:underline wavy {color}">{html.escape(inside or " ")}</span>'
            label = f"  <i>{html.escape(d.label)}</i>" if d.label else ""
            parts.append(f"{p.line:4} | {html.escape(before)}{under}{html.escape(after)}{label}")
        elif p:
            parts.append(html.escape(f"     | {p}"))
        if d.help:
            parts.append(f"     = {html.escape(d.help)}")
        out.append("\n".join(parts))
    return "<pre>" + "\n\n".join(out) + "</pre>" if out else ""


class CellError(Error):
    """What is wrong with a cell stands above it, underlined; the cells that follow are not run."""

    def __init__(self, count: int):
        super().__init__(f"{count or 'an'} error{'s' if count > 1 else ''} in this cell, shown above")

    def _render_traceback_(self) -> List[str]:
        return [f"bmod: {self}"]


def register(shell: Any) -> None:
    """Adds the magic to a shell of IPython."""
    from IPython.core.error import UsageError
    from IPython.display import HTML, display

    def bmod(line: str, cell: str) -> None:
        """Runs a model: %%bmod [RESULT] [--in NAME …] [--out NAME …] [-D NAME=VALUE] [--time-limit SECONDS] [--quiet]"""
        try:
            a = _parser().parse_args(shlex.split(line))
        except SystemExit:
            raise UsageError(_parser().format_usage()) from None
        defines = [d.partition("=") for d in a.define]
        model = Model.from_text(cell, name="cell.blk", define={k: v for k, _, v in defines})
        model._model.allow_read(".")
        for name in a.inputs:
            if name not in shell.user_ns:
                raise UsageError(f"there is no variable {name}")
            model[name] = shell.user_ns[name]
        with warnings.catch_warnings():
            # They are shown with their places.
            warnings.simplefilter("ignore")
            result: Result = model.run(time_limit=a.time_limit, check=False, progress=not a.quiet)
        if result.diagnostics:
            display(HTML(marked(result.diagnostics, cell, "cell.blk")))
        if result.printed and not a.quiet:
            print(result.printed, end="")
        for figure in result.figures.values():
            display(figure)
        if a.result:
            shell.user_ns[a.result] = result
        if not result.ok and not result.interrupted:
            raise CellError(sum(d.severity == "error" for d in result.diagnostics))
        for name in a.outputs:
            value = result[name]
            is_single = result.symbol(name).kind in ("variable", "equation") and not result.symbol(name).domain
            shell.user_ns[name] = float(value.level) if is_single else value

    shell.register_magic_function(bmod, "cell", "bmod")
