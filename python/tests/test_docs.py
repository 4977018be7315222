"""The programs in the pages run."""

import pathlib
import re

import pytest

DOCS = pathlib.Path(__file__).parent.parent.parent / "docs"


@pytest.mark.parametrize("page", ["python.md", "python_users.md"])
def test_programs(page, monkeypatch):
    monkeypatch.chdir(DOCS.parent)
    blocks = re.findall(r"^```python\n(.*?)^```", (DOCS / page).read_text(encoding="utf-8"), re.S | re.M)
    assert blocks
    names = {}
    for block in blocks:
        # `r.objective   # 285.0`: what a comment says is compared where it is a number.
        exec(compile(block, page, "exec"), names)
        for line in block.splitlines():
            said = re.match(r"(\S.*?)\s+# (-?[\d.]+)$", line)
            if said:
                assert eval(said[1], names) == pytest.approx(float(said[2])), line
