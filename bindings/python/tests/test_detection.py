"""The detector that learns from injected targets: a small run of the example, and its ROC curves."""

import json
import pathlib
import runpy
import sys

import numpy
import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

import detection  # noqa: E402

TRAIN, TEST = 48, 48
# Standard error of the area under a curve that knows nothing (Mann and Whitney).
CHANCE_ERROR = numpy.sqrt((TEST + 1) / (12 * (TEST / 2) ** 2))


@pytest.fixture(scope="module")
def described():
    return detection.describe(detection.chips(1, TRAIN)), detection.describe(detection.chips(2, TEST))


def fit_and_try(described, labels):
    (features, _), (unseen, kinds) = described
    model = detection.LogisticRegression(features, labels)
    _, area, _ = detection.curves_of(model, unseen, kinds)["mine or all others"]
    return area


def test_mines_are_told_from_the_rest_on_unseen_swaths(described):
    kinds = described[0][1]
    assert sorted(set(kinds)) == ["mine", "nothing", "rock"]
    assert fit_and_try(described, (kinds == "mine").astype(float)) > 0.5 + 4 * CHANCE_ERROR


def test_labels_that_say_nothing_teach_nothing(described):
    """On average over shuffles: one alone may be right by chance, and reach the features' 0 or 1."""
    random = numpy.random.default_rng(3)
    labels = (described[0][1] == "mine").astype(float)
    areas = [fit_and_try(described, random.permutation(labels)) for _ in range(100)]
    assert abs(numpy.mean(areas) - 0.5) < 4 * numpy.std(areas) / numpy.sqrt(len(areas))


def test_chips_are_drawn_anew_from_each_seed():
    first, again, other = (next(detection.chips(seed, 1))[0] for seed in (1, 1, 2))
    assert numpy.array_equal(first, again) and not numpy.array_equal(first, other)


def test_curves_of_known_scores():
    scores, labels = numpy.array([0.9, 0.8, 0.8, 0.1]), numpy.array([1, 1, 0, 0])
    curve = detection.roc(scores, labels)
    assert [list(axis) for axis in curve] == [[0, 0, 0.5, 1], [0, 0.5, 1, 1]]
    assert detection.area(curve, labels)[0] == 0.875
    assert detection.area(detection.roc(-scores, labels), labels)[0] == 0.125


def test_the_example_runs_and_takes_real_chips(tmp_path, monkeypatch, capsys):
    lines = ["file,mine"]
    for number, (chip, kind) in enumerate(detection.chips(5, 4)):
        numpy.save(tmp_path / f"{number}.npy", chip)
        lines.append(f"{number}.npy,{int(kind == 'mine')}")
    table = tmp_path / "labels.csv"
    table.write_text("\n".join(lines) + "\n")
    monkeypatch.setattr(sys, "argv", ["detection.py", "--train", "8", "--test", "8", "--chips", str(table)])
    runpy.run_path(str(EXAMPLES / "detection.py"), run_name="__main__")
    told = json.loads(capsys.readouterr().out)
    assert set(told) == {"mine or all others", "mine or rock", "mine or nothing", "real chips"}
    assert all(0 <= entry["area"] <= 1 for entry in told.values())
