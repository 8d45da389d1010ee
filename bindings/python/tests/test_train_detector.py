"""Tests of the example that trains a detector on a campaign."""

import pathlib
import re
import sys

import numpy
import pytest

import sonject

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "examples"))

import train_detector  # noqa: E402

GEOMETRY = {"row_spacing": 0.05, "column_spacing": 0.05, "first_slant_range": 40}
SONAR = {"frequency": "100 kHz", "bandwidth": "30 kHz", "altitude": "10 m"}
SCENE = """\
sonject: 1
input: {geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 40 m}}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}
"""
CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: 160
empty: 0.5
chip: {rows: 64, columns: 96}
splits: {train: 0.5, val: 0.5}
swaths: [{path: swath_1.npy}, {path: swath_2.npy}]
draw: {"objects[].level.over_seabed": {uniform: [%s dB, %s dB]}}
targets: [{class: ball, object: {shape: sphere, diameter: %s, burial: {fraction: 0.2}}}]
"""


@pytest.fixture
def tell(tmp_path, monkeypatch, capsys):
    """Returns the example's output for a campaign of such levels (dB) and size, and the numbers in it."""
    for seed in (1, 2):
        seabed = {"rows": 300, "columns": 400, "seed": seed, "ripple_contrast": 0.1 * seed}
        made = sonject.Scene(sonar=SONAR, input={"synthetic": seabed, "geometry": GEOMETRY})
        numpy.save(tmp_path / f"swath_{seed}.npy", sonject.inject(None, made).image)
    (tmp_path / "scene.yaml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)

    def run(low, high, diameter, *arguments, clutter=""):
        (tmp_path / "campaign.yaml").write_text(CAMPAIGN % (low, high, diameter) + clutter)
        monkeypatch.setattr(sys, "argv", ["train_detector.py", "campaign.yaml", *arguments])
        train_detector.main()
        text = capsys.readouterr().out
        return text, *(float(number) for number in re.findall(r"\d+\.?\d*", text))

    return run


def test_it_finds_what_can_be_seen_and_nothing_else(tell):
    text, images, targets, empty, clutter, area, error, *_ = tell(12, 18, "0.5 m")
    assert (images, targets, empty, clutter) == (80, 40, 40, 0)
    assert area - 3 * error > 0.9
    assert "\n40 images without a target cannot tell a false alarm rate below 7.2 % from none\nnone of these has clutter:" in text
    _, _, _, _, _, area, error, *_ = tell(-20, -10, "2 cm")
    assert abs(area - 0.5) < 4 * max(error, 0.065)  # 0.065 is the error of a guess among 40 and 40


def test_clutter_is_told(tell):
    text, _, targets, others, clutter, *_ = tell(12, 18, "0.5 m", clutter="""\
clutter: {alone: 0.25, number: 0, objects: [{class: stone, object: {shape: sphere, diameter: 0.3 m, burial: {fraction: 0.5}}}]}
""")
    assert targets + others == 80 and 10 <= clutter <= 30 and "clutter.alone" not in text


def test_a_split_that_is_not_there_is_told(tell):
    with pytest.raises(SystemExit, match="no split 'test'"):
        tell(12, 18, "0.5 m", "--try", "test")


def test_areas_of_known_scores():
    labels = numpy.array([True, True, False, False])
    scores = numpy.array([0.9, 0.8, 0.8, 0.1])
    assert train_detector.area_under_curve(scores, labels)[0] == 0.875
    assert train_detector.area_under_curve(-scores, labels)[0] == 0.125
