"""The notebook runs, and the cell magic shows what it should."""

import pathlib

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

NOTEBOOKS = pathlib.Path(__file__).parent.parent / "notebooks"


def execute(notebook, folder):
    client = nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}})
    return client.execute()


@pytest.mark.parametrize("path", sorted(NOTEBOOKS.glob("*.ipynb")), ids=lambda p: p.stem)
def test_notebooks(path):
    execute(nbformat.read(path, as_version=4), path.parent)


def test_magic(tmp_path):
    cells = [
        "%load_ext bmod\ndemand = {'a': 3, 'b': 4}",
        "%%bmod r --in demand --out total\nset i / a, b /; parameter demand(i); scalar total;\ntotal = sum(i, demand(i)); display total;\nfigure f { points x = 1, y = 1; };\ndraw f 'f.svg';",
        "total, r['demand']['b']",
        "%%bmod\nscalar s;\ns = nonsense;",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    notebook.cells[-1].metadata["tags"] = ["raises-exception"]
    done = execute(notebook, tmp_path).cells

    def shown(cell, kind):
        return "".join(o.get("data", {}).get(kind, "") for o in cell.outputs)

    assert "<svg" in shown(done[1], "image/svg+xml")
    assert "(7.0, np.float64(4.0))" in shown(done[2], "text/plain")
    assert "underline" in shown(done[3], "text/html")
    error = [o for o in done[3].outputs if o.output_type == "error"]
    assert error[0].traceback == ["bmod: 1 error in this cell, shown above"]
