"""Conversions."""

import numpy
import pytest

import sonject


def test_an_array_becomes_an_image_and_comes_back(tmp_path):
    pixels = numpy.arange(12, dtype=numpy.uint16).reshape(3, 4)
    numpy.save(tmp_path / "a.npy", pixels)
    geometry = {"row_spacing": 0.1, "column_spacing": "25 cm", "first_slant_range": 5.0}
    sonject.convert(tmp_path / "a.npy", tmp_path / "b.tif", geometry=geometry, altitude_m=3.0)
    assert b"sonject:first_slant_range_m=5\n" in (tmp_path / "b.tif").read_bytes()
    sonject.convert(tmp_path / "b.tif", tmp_path / "c.npy", samples=sonject.Samples.FLOAT32,
                    scale=0.5)
    sonject.convert(tmp_path / "b.tif", tmp_path / "d.tif",
                    geometry={**geometry, "first_slant_range": 0.0, "nadir_column": 1.5})
    told = (tmp_path / "d.tif").read_bytes()
    assert b"sonject:first_slant_range_m=0\n" in told and b"sonject:nadir_column=1.5\n" in told
    back = numpy.load(tmp_path / "c.npy")
    assert back.dtype == numpy.float32 and numpy.array_equal(back, pixels / 2)


def test_what_does_not_fit_is_refused(tmp_path):
    numpy.save(tmp_path / "a.npy", numpy.full((3, 4), 300, numpy.uint16))
    with pytest.raises(sonject.SonjectError, match="would become 300"):
        sonject.convert(tmp_path / "a.npy", tmp_path / "b.tif", samples=sonject.Samples.UINT8)
    with pytest.raises(ValueError, match="array contains a NUL"):
        sonject.convert(tmp_path / "a.npy", tmp_path / "b.npy", array="swath\0of another day")
    assert [path.name for path in tmp_path.iterdir()] == ["a.npy"]
