"""sonject init: a scene to begin with, from an image and a few answers."""

import json
import re

import numpy
import pytest

import recordings
from made_swaths import KINDS, LEVEL_DB, ROWS, Made

ANSWERS = ["5 cm", "2.5 cm", "44 m", "10 m", "100 kHz", "30 kHz", ""]


@pytest.fixture
def image(tmp_path):
    numpy.save(tmp_path / "swath.npy", Made("gamma").numbers)
    return tmp_path / "swath.npy"


def init(sonject, *arguments, answers):
    return sonject("init", *arguments, input="".join(f"{answer}\n" for answer in answers))


def test_what_it_writes_runs(sonject, image):
    answer = init(sonject, "swath.npy", answers=ANSWERS)
    assert answer.returncode == 0, answer.stderr
    assert "object 1   target (cylinder)" in answer.stdout
    scene = image.with_suffix(".yaml").read_text()
    for line in ('path: "swath.npy"', "row_spacing: 5 cm", "column_spacing: 2.5 cm", "first_slant_range: 44 m",
                 "altitude: 10 m", "frequency: 100 kHz", "bandwidth: 30 kHz"):
        assert f"  {line}" in scene
    assert "kind: real" not in scene
    assert "kind: gamma" in (image.parent / "swath_calibration.yaml").read_text()
    sonject.done("run", "swath.yaml", "-o", "out")
    assert (image.parent / "out" / "truth.json").exists()


def test_a_wrong_answer_is_asked_for_again(sonject, image):
    answer = init(sonject, "swath.npy", answers=["", "5 xx", "-1 m", *ANSWERS])
    assert answer.returncode == 0, answer.stderr
    assert "unit 'xx' is not one of m, km, cm, mm" in answer.stderr and "must be" in answer.stderr
    assert "row_spacing: 5 cm" in image.with_suffix(".yaml").read_text()


def test_no_answer_leaves_no_file(sonject, image):
    answer = init(sonject, "swath.npy", answers=ANSWERS[:2])
    assert answer.returncode == 2 and "no answer was given for input.geometry.first_slant_range" in answer.stderr
    assert [path.name for path in image.parent.iterdir()] == ["swath.npy"]


def test_a_file_that_is_there_stays(sonject, image):
    image.with_suffix(".yaml").write_text("mine")
    answer = init(sonject, "swath.npy", answers=ANSWERS)
    assert answer.returncode == 3 and "swath.yaml: is there already" in answer.stderr
    assert image.with_suffix(".yaml").read_text() == "mine"


def test_an_array_makes_a_sidescan_and_the_scene_may_lie_elsewhere(sonject, image):
    (image.parent / "scenes").mkdir()
    answer = init(sonject, "swath.npy", "-o", "scenes/mine.yaml", answers=[*ANSWERS[:-1], "0.5 m"])
    assert answer.returncode == 0, answer.stderr
    scene = (image.parent / "scenes" / "mine.yaml").read_text()
    assert "kind: real\n  array: {length: 0.5 m}" in scene and "calibration: mine_calibration.yaml" in scene
    sonject.done("check", "scenes/mine.yaml")


def test_what_the_file_tells_is_not_asked_for(sonject, image):
    """A geometry without an altitude."""
    sonject.done("convert", "swath.npy", "swath.tif", "--row-spacing", "0.025", "--column-spacing", "0.025",
                 "--first-range", "44")
    answer = init(sonject, "swath.tif", answers=ANSWERS[3:])
    assert answer.returncode == 0, answer.stderr
    scene = image.with_suffix(".yaml").read_text()
    assert "geometry: from_file" in scene and "altitude: 10 m" in scene


@pytest.mark.parametrize("typed", ["", "from_file"])
def test_a_recording_tells_the_geometry(sonject, tmp_path, typed):
    sides = [numpy.random.default_rng(7).rayleigh(2000.0, (120, 400)).astype(numpy.uint16) for _ in range(2)]
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=numpy.linspace(5.0, 9.0, 120)))
    answer = init(sonject, "line.xtf", "--channel", "port", answers=[typed, "600 kHz", "", "0.5 m"])
    assert answer.returncode == 0, answer.stderr
    assert "the file's mean is 7 m [from_file]: " in answer.stderr
    scene = (tmp_path / "line.yaml").read_text()
    assert "bandwidth: 10 kHz # c / 2 over the column spacing" in scene  # of 400 columns to 30 m
    assert "channel: port" in scene and "geometry: from_file" in scene and "altitude: from_file" in scene


def test_an_answer_from_a_file_that_does_not_tell_it_is_asked_for_again(sonject, image):
    answer = init(sonject, "swath.npy", answers=[*ANSWERS[:3], "from_file", *ANSWERS[3:5], "", ""])
    assert answer.returncode == 0, answer.stderr
    assert "does not say the sonar's altitude: give it instead of from_file" in answer.stderr
    assert "bandwidth: 30 kHz # c / 2 over the column spacing" in image.with_suffix(".yaml").read_text()  # 2.5 cm


@pytest.mark.parametrize("kind, level", [("gamma", 15), ("intensity", None)])
def test_the_level_is_up_to_the_ceiling(sonject, tmp_path, kind, level):
    """By the calibration, in whole dB."""
    made = Made(kind)
    numpy.save(tmp_path / "swath.npy", made.numbers)
    answer = init(sonject, "swath.npy", answers=ANSWERS)
    assert answer.returncode == 0, answer.stderr
    found = json.loads(sonject.done("calibrate", "swath.npy", "--json").stdout)["measured"]["ceiling_over_seabed"]
    mean = 10 * numpy.log10(KINDS[kind][1] ** 2)  # of the seabed's level, over full scale
    assert found["value"] == pytest.approx(-mean, abs=4 * found["standard_error"] + LEVEL_DB / 4)
    told = float(re.search(r"level: {over_seabed: (\d+) dB}", (tmp_path / "swath.yaml").read_text())[1])
    assert told == (level or numpy.floor(found["value"])) <= 15


def test_altitude_by_first_returns_is_what_enter_takes(sonject, tmp_path):
    numpy.save(tmp_path / "swath.npy", Made("amplitude", water=numpy.full(ROWS, 120)).numbers)
    sonject.done("convert", "swath.npy", "swath.tif", "--row-spacing", "0.025", "--column-spacing", "0.025",
                 "--first-range", "0")
    answer = init(sonject, "swath.tif", answers=["", "100 kHz", "", ""])
    assert answer.returncode == 0, answer.stderr
    told = re.search(r"altitude: (\S+) m", (tmp_path / "swath.yaml").read_text())[1]
    assert float(told) == pytest.approx(120 * 0.025, rel=0.02) and f"as first returns show it [{told} m]" in answer.stderr
