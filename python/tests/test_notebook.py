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
    done = execute(notebook, tmp_path).cells
    kinds = [kind for o in done[1].outputs for kind in o.get("data", {})]
    assert "image/svg+xml" in kinds
    assert "(7.0, np.float64(4.0))" in done[2].outputs[0]["data"]["text/plain"]
    assert "underline" in done[3].outputs[0]["data"]["text/html"]
