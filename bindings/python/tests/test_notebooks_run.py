"""Tests that the notebooks run from end to end. They assert their own statements."""

import nbclient
import nbformat

import pytest

from test_notebooks import NOTEBOOKS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_no_cell_fails(path, tmp_path):
    notebook = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=None, kernel_name="python3", resources=place).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any(output.output_type == "stream" and output.name == "stdout" for output in outputs)
    assert any("image/png" in output.get("data", {}) or "<img" in output.get("data", {}).get("text/html", "")
               for output in outputs)
