"""Tests of calibrations of arrays and files."""

import json

import numpy
import pytest

import sonject


def decibels(rows=320, columns=320):
    """Returns speckle of one look in grey levels of 0.3 dB."""
    intensity = numpy.random.default_rng(4).exponential(size=(rows, columns))
    return numpy.clip(numpy.round((10 * numpy.log10(intensity) + 50) / 0.3), 0, 255).astype(numpy.uint8)


def test_an_array_tells_what_its_file_tells(tmp_path):
    numpy.save(tmp_path / "swath.npy", decibels())
    of_array = sonject.calibrate(decibels())
    of_file = sonject.calibrate(tmp_path / "swath.npy", output=tmp_path / "swath.json",
                                picture=tmp_path / "swath.png")
    transfer = of_array["input"]["transfer"]
    told = of_array["measured"]["transfer"]["parameter"]
    assert transfer["kind"] == "decibel"
    assert abs(told["value"] - 0.3) < 4 * told["standard_error"] < 0.06
    assert json.loads((tmp_path / "swath.json").read_text()) == of_file
    assert (tmp_path / "swath.png").stat().st_size > 1000
    assert of_file["measured"].pop("swath") == "swath.npy"
    assert len(of_file["measured"].pop("swath_xxh3")) == 32
    assert of_array == of_file


def test_a_scene_takes_it(tmp_path):
    numpy.save(tmp_path / "swath.npy", decibels())
    found = sonject.calibrate(tmp_path / "swath.npy", output=tmp_path / "swath.json")
    found["injection"] = {"noise_floor": "-23 dB"}
    (tmp_path / "swath.json").write_text(json.dumps(found))
    scene = sonject.Scene(
        sonar={"frequency": "100 kHz", "bandwidth": "30 kHz", "altitude": 10},
        input={"calibration": str(tmp_path / "swath.json"),
               "geometry": {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 40}},
        objects=[{"shape": "sphere", "diameter": 0.5}])
    patch = numpy.random.default_rng(1).rayleigh(size=(64, 64)).astype(numpy.float32)
    statistics = sonject.inject(patch, scene).statistics
    assert statistics.noise_floor_db == pytest.approx(-23)
    assert statistics.noise_floor_source == 2


def test_what_is_no_swath_is_refused():
    with pytest.raises(sonject.SonjectError):
        sonject.calibrate(numpy.full((64, 64), numpy.nan, numpy.float32))
    with pytest.raises(TypeError):
        sonject.calibrate(numpy.full((64, 64), "a"))
