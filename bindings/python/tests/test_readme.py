"""The examples of the README and of the package's documentation run as they stand."""

import ast
import logging
import re
import shutil

import numpy
import pytest

import sonject
from conftest import DOCUMENTS, KEYS, PACKAGE

README = (DOCUMENTS / "README.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.S)
SPANS = list(dict.fromkeys(re.findall(r"(?<!`)`([^`\n]+)`(?!`)", README)))
# Run elsewhere: shells' by tests/cli/test_pages.py, pictures by test_plotting.py.
ELSEWHERE = ("SONJECT_LIBRARY", "tools/scenes/KEYS.md", "PYTHONPATH", "sonject.plotting.draw_result(", "examples/", "tools/", "env/bin/")


@pytest.fixture(scope="module")
def names():
    """Returns names that the README's program leaves, for the words of the text under it."""
    example = EXAMPLES[0]
    names = dict(vars(sonject))
    exec(compile(example, "README.md", "exec"), names)
    return {**names, "sonject": sonject}


def test_the_example_runs(names, capsys):
    exec(compile(EXAMPLES[0], "README.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "(128, 160) float32"
    assert len(lines) == 3
    assert names["result"].objects[0].is_visible


def test_the_example_of_a_campaign_runs(campaign_folder, capsys, monkeypatch):
    monkeypatch.chdir(campaign_folder)
    exec(compile(EXAMPLES[1], "README.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert len(EXAMPLES) == 3 and len(lines) == 6
    assert {line.rsplit("(64, 64)")[-1] for line in lines} == {" True", " False"}


def test_the_example_of_a_data_set_has_the_boxes_of_targets(campaign_folder, monkeypatch):
    """The outermost pixels of boxes are those of the layer labels; clutter has no boxes."""
    monkeypatch.chdir(campaign_folder)
    with open("campaign.yaml", "a", encoding="utf-8") as file:
        file.write("clutter: {number: 1, alone: 0.2, objects: [{class: stone, object: {shape: sphere, diameter: 25 cm}}]}\n")
    names = {}
    exec(compile(EXAMPLES[2], "README.md", "exec"), names)
    chips = names["chips"]
    seen = set()
    for number in range(len(chips)):
        image, boxes, labels = chips[number]
        made = chips.campaign[number]
        assert numpy.array_equal(image, made.image) and len(boxes) == len(labels)
        assert labels == (["ball"] if chips.campaign.describe(number).has_target else [])
        for left, top, right, bottom in boxes:
            rows, columns = numpy.nonzero(made.labels == 1)
            assert (left, top) == (columns.min(), rows.min())
            assert (right, bottom) == (columns.max() + 1, rows.max() + 1)
        seen.add((len(made.objects), len(boxes)))
    assert seen == {(0, 0), (1, 0), (2, 1)}  # empty, clutter alone, a target beside clutter


def calls():
    """Returns the spans that are more than a name."""
    found = [span for span in SPANS if not span.startswith(ELSEWHERE)]
    return [span for span in found if re.search(r"[(\[.]", span)]


def is_python(span):
    try:
        ast.parse(span)
    except SyntaxError:
        return False
    return True


@pytest.mark.parametrize("span", calls())
def test_what_the_text_calls_can_be_called(names, span, tmp_path, monkeypatch):
    assert is_python(span)
    shutil.copytree(DOCUMENTS.parents[1] / "tools" / "scenes", tmp_path / "tools" / "scenes")
    monkeypatch.chdir(tmp_path)
    scene = sonject.Scene(**KEYS)
    scene["input.uniform"] = {"rows": 32, "columns": 40}
    patch = numpy.full((32, 40), 0.1, numpy.float32)
    meant = {
        "scene": scene,
        "patch": patch,
        "grey": numpy.full((32, 40), 90, numpy.uint8),
        "curve": sonject.Transfer("{kind: gamma, parameter: 2.2}"),
        "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        "heights": [0.0, 10.0],
        "speeds": [1490.0, 1500.0],
        "along": [-10.0, 10.0],
        "sway": [0.0, 1e-3],
        "folder": tmp_path / "results",
        "path": tmp_path / "scene.yaml",
        "function": lambda level, line: None,
        "level": logging.WARNING,
        "line": "a note",
    }
    if span.startswith("result.order"):
        scene["injection"] = {"interactions": 2, "order_energies": True}
        meant["result"] = sonject.inject(patch, scene)
    try:
        exec(span, {**names, **meant})
    except sonject.SonjectError as error:
        if error.status is not sonject.Status.ERROR_UNSUPPORTED:  # run, without image files
            raise


def test_names_in_the_text_exist(names):
    """Names may be of the package, of its classes, or of its functions' parameters."""
    source = "".join(path.read_text(encoding="utf-8")
                     for path in PACKAGE.glob("*.py"))
    words = set(re.findall(r"\w+", source)) | {"float32", "complex64"}
    plain = [span.rstrip("=") for span in SPANS
             if not span.startswith((*ELSEWHERE, '"')) and span not in calls()]
    assert len(plain) > 20
    assert sorted(set(plain) - words) == []


def test_the_example_of_the_package_runs():
    lines = re.findall(r"^(?:>>>|\.\.\.) ?(.*)$", sonject.__doc__, flags=re.M)
    assert len(lines) > 4
    meant = {"patch": numpy.full((32, 40), 0.1, numpy.float32)}
    exec("\n".join(lines), meant)
    assert meant["result"].objects[0].is_visible
