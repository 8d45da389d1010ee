"""Tests of sonject elements, which makes series of an array from a scene's own image."""

import json
import math

import numpy

from conftest import COLUMNS, ROWS, SCENE, assert_refused, files_below

ARRAY = "elements: {hydrophones: {count: 2}, pings: {count: 3, first: 1 m, spacing: 0.1 m}}\n"


def test_files_hold_the_series(sonject, scene, tmp_path):
    scene.write_text(SCENE + ARRAY)
    answer = sonject.done("elements", scene, "-o", "out", "--quiet")
    assert not answer.stdout and not answer.stderr
    names = [path.name for path in files_below(tmp_path / "out")]
    assert names == ["elements.json", "series.npy"]
    facts = json.loads((tmp_path / "out" / "elements.json").read_text())
    series = numpy.load(tmp_path / "out" / "series.npy")
    assert series.shape == (3, 2, facts["samples"]) and series.dtype == numpy.complex64
    assert (facts["image"]["rows"], facts["image"]["columns"]) == (ROWS, COLUMNS)
    assert facts["array"]["hydrophone_length_m"] == 0.05  # twice the resolution
    assert facts["array"]["first_hydrophone_m"] == -0.025
    assert facts["heard"] == "targets" and facts["image"]["range_grows"] == "right"
    # the ball stands on the seabed point in the middle: its glint comes from 25 cm before its centre
    peak = facts["first_time_s"] + numpy.abs(series[0, 0]).argmax() / facts["sampling_rate_hz"]
    ground = math.sqrt((25 + 0.025 * (COLUMNS - 1) / 2) ** 2 - 10**2)
    nearest = math.hypot(ground, 10 - 0.25) - 0.25
    assert abs(peak * 1500 / 2 - nearest) < 0.5 * 0.025
    # the resolution is just above a quarter of the wavelength of 15 mm
    sonject.done("elements", scene, "-o", "fine", "--set", "sonar.resolution=4 mm")
    sonject.done("elements", scene, "-o", "real", "--set", "elements.form=passband")
    assert numpy.load(tmp_path / "real" / "series.npy").dtype == numpy.float32


def test_series_of_other_inputs_are_refused_and_lost_ones_made_again(sonject, scene, tmp_path):
    scene.write_text(SCENE + ARRAY)
    file = tmp_path / "out" / "series.npy"
    sonject.done("elements", scene, "-o", "out")
    first, made = file.read_bytes(), file.stat().st_mtime_ns
    sonject.done("elements", scene, "-o", "out")
    assert file.stat().st_mtime_ns == made
    for key in ("injection.seed", "elements.pings.count", "objects[0].diameter"):
        changed = ["--set", f"{key}=2"]
        differs = key.removesuffix(".diameter").removesuffix(".pings.count")
        assert_refused(sonject("elements", scene, "-o", "out", *changed), 2, f"differs in {differs}")
    file.write_bytes(first[:-1])
    sonject.done("elements", scene, "-o", "out")
    assert file.read_bytes() == first
    sonject.done("elements", scene, "-o", "out", *changed, "--overwrite")
    assert file.read_bytes() != first


def test_what_is_wrong_leaves_nothing(sonject, scene, tmp_path):
    scene.write_text(SCENE + ARRAY)
    for setting, words in (
            ("sonar.resolution=3.7 mm", "no aperture on a straight track resolves 0.0037 m"),
            ("sonar.motion={random: {rms: 1 mm, correlation: 1 m}}", "sonar.motion works only in images"),
            ("objects[0].level={over_seabed: 14 dB}", "objects[0].level works only in images")):
        assert_refused(sonject("elements", scene, "-o", "out", "--set", setting), 3, words)
    assert not files_below(tmp_path / "out")
    assert_refused(sonject("elements", scene, "-o", "scene.yaml/out", "--quiet"), 5, "scene.yaml")
