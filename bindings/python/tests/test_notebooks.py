"""Tests that the notebooks are short, have no outputs and use only existing names, and that the first one
runs. test_notebooks_run.py runs all of them, and needs Jupyter's client."""

import ast
import json

import pytest

import sonject
from conftest import DOCUMENTS

NOTEBOOKS = sorted((DOCUMENTS.parents[1] / "docs" / "notebooks").glob("*.ipynb"))


def cells(path, kind):
    """Returns the texts of the notebook's cells of that kind."""
    written = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in written if cell["cell_type"] == kind]


def test_all_are_here():
    assert [path.stem for path in NOTEBOOKS] == ["first_injection", "physics", "training_set"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_they_are_short_and_without_outputs(path):
    written = json.loads(path.read_text(encoding="utf-8"))
    assert len(written["cells"]) <= 12 and (written["nbformat"], written["nbformat_minor"]) == (4, 4)
    for cell in written["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
        assert cell["metadata"] == {}
    assert len(cells(path, "code")) + len(cells(path, "markdown")) == len(written["cells"])


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_what_they_name_exists(path):
    tree = ast.parse("\n".join(cells(path, "code")))
    assert any(isinstance(node, ast.Assert) for node in ast.walk(tree))
    names = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)
             and isinstance(node.value, ast.Name) and node.value.id == "sonject"}
    assert names and sorted(names - set(dir(sonject))) == []


def test_the_first_runs(capsys):
    (first,) = (path for path in NOTEBOOKS if path.stem == "first_injection")
    names = {}
    for code in cells(first, "code"):
        exec(compile(code, first.name, "exec"), names)
    assert capsys.readouterr().out.startswith("(240, 320) float32\ntarget strength -")
    assert names["injected"].image.dtype == "uint8"
