"""Tests of conversions."""

import numpy
import pytest

import sonject


def test_an_array_becomes_an_image_and_comes_back(tmp_path):
    pixels = numpy.arange(12, dtype=numpy.uint16).reshape(3, 4)
    numpy.save(tmp_path / "a.npy", pixels)
    geometry = {"row_spacing": 0.1, "column_spacing": "25 cm", "first_slant_range": 5.0}
    sonject.convert(tmp_path / "a.npy", tmp_path / "b.tif", geometry=geometry, altitude_m="300 cm")
    told = (tmp_path / "b.tif").read_bytes()
    assert b"sonject:first_slant_range_m=5\n" in told and b"sonject:altitude_m=3\n" in told
    sonject.convert(tmp_path / "b.tif", tmp_path / "c.npy", )
    sonject.convert(tmp_path / "b.tif", tmp_path / "d.tif",
                    geometry={**geometry, "first_slant_range": 0.0, "nadir_column": 1.5})
    told = (tmp_path / "d.tif").read_bytes()
    assert b"sonject:first_slant_range_m=0\n" in told and b"sonject:nadir_column=1.5\n" in told
    back = numpy.load(tmp_path / "c.npy")
    assert back.dtype == numpy.uint16 and numpy.array_equal(back, pixels)


def test_what_does_not_fit_is_refused(tmp_path):
    numpy.save(tmp_path / "a.npy", numpy.full((3, 4), 0.5, numpy.float32))
    with pytest.raises(sonject.SonjectError, match="does not hold floating-point samples"):
        sonject.convert(tmp_path / "a.npy", tmp_path / "b.png")
    with pytest.raises(sonject.SonjectError, match="black_db must be below white_db"):
        sonject.convert(tmp_path / "a.npy", tmp_path / "b.npy", grey=(0, -60))
    with pytest.raises(ValueError, match="array contains a NUL"):
        sonject.convert(tmp_path / "a.npy", tmp_path / "b.npy", array="swath\0of another day")
    assert [path.name for path in tmp_path.iterdir()] == ["a.npy"]


def test_grey_levels_are_in_decibels_over_full_scale(tmp_path):
    numpy.save(tmp_path / "a.npy", numpy.array([[0, 0.001, 0.1, 1, 2j]], numpy.complex64))
    sonject.convert(tmp_path / "a.npy", tmp_path / "b.npy", grey=(-60, 0))
    assert numpy.load(tmp_path / "b.npy").tolist() == [[0, 0, 170, 255, 255]]


def test_the_ends_of_a_picture_may_have_a_unit(tmp_path):
    numpy.save(tmp_path / "a.npy", numpy.linspace(0.1, 1.0, 48, dtype=numpy.float32).reshape(6, 8))
    pictures = []
    for decibels in ((-20, 0), ("-20 dB", "0 dB"), ("-10 dB", 0)):
        sonject.quicklook(tmp_path / "a.npy", tmp_path / "a.png", decibels=decibels)
        pictures.append((tmp_path / "a.png").read_bytes())
    assert pictures[0] == pictures[1] != pictures[2]
    with pytest.raises(TypeError, match="decibels must be a number or a text such as '-20 dB', not 'loud'"):
        sonject.quicklook(tmp_path / "a.npy", tmp_path / "a.png", decibels=("loud", 0))
