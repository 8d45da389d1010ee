"""Tests of HDF5 and MATLAB arrays as input. h5py and scipy write and read the files."""

import json

import numpy
import pytest

import images
from conftest import COLUMNS, ROWS, SCENE, assert_refused
from measured_images import read_png

h5py = pytest.importorskip("h5py")
scipy_io = pytest.importorskip("scipy.io")


def write_scene(folder, name, keys=""):
    path = folder / f"{name}.yaml"
    path.write_text(SCENE.replace("path: swath.tif", f"path: {name}\n  {keys}".rstrip()))
    return path


def assert_target_is_there(before, after):
    assert after.dtype == before.dtype and after.shape == before.shape
    assert (after != before).sum() > 50
    assert (after == before).sum() > before.size / 4


def others(group):
    """Returns all that a file holds except the image's values: values, attributes, types and storage."""
    found = {}

    def note(name, thing):
        facts = [str(dict(thing.attrs))]
        if isinstance(thing, h5py.Dataset):
            facts += [str(thing.dtype), thing.chunks, thing.compression, thing.maxshape]
            if name != "image":
                facts.append(str(thing[()]))
        found[name] = facts

    group.visititems(note)
    return found


@pytest.mark.parametrize("kind, storage", [("f8", "gzip"), ("c8", "plain"), ("u2", "plain")])
def test_hdf5(sonject, tmp_path, swath, kind, storage):
    image = (swath * 20000 if kind == "u2" else swath.astype("f8") * 1.1).astype(kind)
    options = {} if storage == "plain" else {"chunks": (17, 31), "compression": "gzip",
                                             "shuffle": True}
    with h5py.File(tmp_path / "line.h5", "w") as file:
        file.create_dataset("image", data=image, **options)
        file["image"].attrs["units"] = "Pa"
        file["more/rate"] = 48000.0
        file["more/note"] = "of the operator"
        file["names"] = numpy.array([b"a", b"bc"])
    complex_key = "complex: true" if kind.startswith("c") else ""
    sonject.done("run", write_scene(tmp_path, "line.h5", complex_key), "-o", "out")
    with h5py.File(tmp_path / "line.h5") as before, \
            h5py.File(tmp_path / "out/image.h5") as after:
        assert_target_is_there(before["image"][()], after["image"][()])
        assert others(before) == others(after)
    if storage == "plain":
        bytes_before, bytes_after = (numpy.fromfile(tmp_path / name, "u1")
                                     for name in ("line.h5", "out/image.h5"))
        changed = numpy.flatnonzero(bytes_before != bytes_after)
        assert changed.max() - changed.min() <= image.nbytes


def test_named_arrays_are_measured_and_drawn(sonject, tmp_path, swath):
    arrays = {"low": swath, "more/high": swath ** 2}
    with h5py.File(tmp_path / "lines.h5", "w") as file:
        for name, image in arrays.items():
            file[name] = image
    measured = {}
    for name, image in arrays.items():
        numpy.save(tmp_path / "line.npy", image)
        answers = [sonject("measure", "lines.h5", "--array", name), sonject("measure", "line.npy")]
        assert answers[0].returncode == 0, answers[0].stderr
        assert answers[0].stdout == answers[1].stdout
        measured[name] = answers[0].stdout
        drawn = [sonject("quicklook", "lines.h5", "--array", name, "-o", "named.png"),
                 sonject("quicklook", "line.npy", "-o", "only.png")]
        assert [answer.returncode for answer in drawn] == [0, 0], drawn[0].stderr
        assert (tmp_path / "named.png").read_bytes() == (tmp_path / "only.png").read_bytes()
    assert measured["low"] != measured["more/high"]
    assert_refused(sonject("measure", "lines.h5"), 3, "low", "more/high")
    assert_refused(sonject("measure", "line.npy", "--array", "low"), 3, "neither HDF5 nor MATLAB")


def write_matlab_73(path, image, compression=None):
    """Writes an image as MATLAB's -v7.3 does. Columns are contiguous, so HDF5 sees the transpose."""
    with h5py.File(path, "w", userblock_size=512) as file:
        pairs = image.T
        if image.dtype.kind == "c":
            part = numpy.dtype(f"f{image.dtype.itemsize // 2}")
            pairs = numpy.zeros(image.T.shape, [("real", part), ("imag", part)])
            pairs["real"], pairs["imag"] = image.T.real, image.T.imag
        file.create_dataset("swath", data=pairs, compression=compression)
        file["swath"].attrs["MATLAB_class"] = numpy.bytes_("double")
        file["fs"] = numpy.array([[48000.0]])
        file["fs"].attrs["MATLAB_class"] = numpy.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    with open(path, "r+b") as file:
        file.write(head)


def test_matlab_7_3(sonject, tmp_path, swath):
    image = swath.astype("c16") / (3 + 1j)
    write_matlab_73(tmp_path / "line.mat", image, "gzip")
    scene = write_scene(tmp_path, "line.mat", "complex: true")
    sonject.done("run", scene, "-o", "out")
    assert ((tmp_path / "out/image.mat").read_bytes()[:512] ==
            (tmp_path / "line.mat").read_bytes()[:512])
    with h5py.File(tmp_path / "out/image.mat") as file:
        after = file["swath"][()].T
        assert file["fs"][()] == 48000.0
    assert_target_is_there(image, after["real"] + 1j * after["imag"])


@pytest.mark.parametrize("kind, compressed", [("f8", False), ("c8", True), ("u1", True)])
def test_matlab_5(sonject, tmp_path, swath, kind, compressed):
    image = numpy.asfortranarray((swath * 300 if kind == "u1" else swath / 3).astype(kind))
    variables = {
        "fs": 48000.0,
        "swath": image,
        "facts": {"ship": "Anna", "pings": numpy.arange(5)},
        "cells": numpy.array([1.5, "text"], object),
        "cube": numpy.arange(24.0).reshape(2, 3, 4),
    }
    scipy_io.savemat(tmp_path / "line.mat", variables, do_compression=compressed)
    keys = "array: swath\n" + ("  complex: true" if kind.startswith("c") else "")
    sonject.done("run", write_scene(tmp_path, "line.mat", keys), "-o", "out")
    before, after = (scipy_io.loadmat(tmp_path / name) for name in ("line.mat", "out/image.mat"))
    assert_target_is_there(before.pop("swath"), after.pop("swath"))
    assert str(before) == str(after)
    if not compressed:
        assert len((tmp_path / "line.mat").read_bytes()) == len(
            (tmp_path / "out/image.mat").read_bytes())


def test_a_damaged_matlab_5_file_is_told(sonject, tmp_path, swath):
    """Wherever a byte is wrong, the variable's checksum tells."""
    scipy_io.savemat(tmp_path / "line.mat", {"swath": swath}, do_compression=True)
    whole = (tmp_path / "line.mat").read_bytes()
    for place in range(2000, len(whole) - 1, len(whole) // 12):
        (tmp_path / "line.mat").write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1:])
        assert_refused(sonject("measure", "line.mat"), 3, "line.mat: cut short or damaged")


@pytest.mark.parametrize("kind, largest", [("u2", 65535), ("i2", 32767), ("i4", 2**31 - 1), ("u4", 2**32 - 1)])
def test_levels_are_over_the_largest_number_of_the_type(sonject, tmp_path, kind, largest):
    """All verbs take the same full scale, that of runs."""
    share = numpy.random.default_rng(3).rayleigh(0.05, (120, 160)).clip(0, 1)
    numpy.save(tmp_path / "line.npy", (share * largest).astype(kind))
    sonject.done("convert", "line.npy", "grey.png", "--db=-60:0")
    expected = 255 * (20 * numpy.log10(share.clip(1e-9)) + 60).clip(0, 60) / 60
    assert numpy.abs(read_png(tmp_path / "grey.png") - expected).max() < 1.6
    measured = json.loads(sonject.done("measure", "line.npy", "--transfer", "schlick:20").stdout)
    linear = (share / (20 - 19 * share)) ** 2
    assert measured["seabed"]["intensity_contrast"] == pytest.approx(linear.std() / linear.mean(), rel=0.1)
    picture = sonject.done("convert", "line.npy", "white.png", "--db=-90:-60")
    assert "% of the pixels are white at grey levels of -90 to -60 dB" in picture.stderr


def test_the_same_pixels_give_the_same_image(sonject, tmp_path, swath, scene):
    """The same pixels are in a float32 TIFF, in float64 in HDF5, and transposed as MATLAB keeps them."""
    double = swath.astype("f8")
    with h5py.File(tmp_path / "line.h5", "w") as file:
        file["image"] = double
    write_matlab_73(tmp_path / "line.mat", double)
    scenes = {"tif": scene, "h5": write_scene(tmp_path, "line.h5"),
              "mat": write_scene(tmp_path, "line.mat")}
    for name, path in scenes.items():
        sonject.done("run", path, "-o", name)
    pixels = (tmp_path / "tif/image.tif").read_bytes()[8:8 + 4 * ROWS * COLUMNS]
    expected = numpy.frombuffer(pixels, "<f4").reshape(ROWS, COLUMNS)
    with h5py.File(tmp_path / "h5/image.h5") as file:
        assert numpy.array_equal(file["image"][()].astype("f4"), expected)
    with h5py.File(tmp_path / "mat/image.mat") as file:
        assert numpy.array_equal(file["swath"][()].T.astype("f4"), expected)


def test_one_of_several_arrays(sonject, tmp_path, swath):
    with h5py.File(tmp_path / "line.h5", "w") as file:
        file["port"] = swath
        file["sides/starboard"] = swath[::-1]
    scene = write_scene(tmp_path, "line.h5")
    assert_refused(sonject("run", scene, "-o", "out"), 3,
                   "port (96 x 128), sides/starboard (96 x 128)")
    sonject.done("run", scene, "-o", "out", "--set", "input.array=sides/starboard")
    with h5py.File(tmp_path / "out/image.h5") as file:
        assert numpy.array_equal(file["port"][()], swath)
        assert_target_is_there(swath[::-1], file["sides/starboard"][()])


@pytest.mark.parametrize("other", ["<i4", "f2", "cube", "damaged"])
def test_an_array_that_cannot_be_read_is_one_of_several(sonject, tmp_path, swath, other):
    """Else the target would go into the mask beside the swath."""
    kind = other if other in ("<i4", "f2") else "f4"
    with h5py.File(tmp_path / "line.h5", "w", libver="latest") as file:
        file["swath"] = (swath[None] if other == "cube" else swath * 100).astype(kind)
        place = h5py.h5o.get_info(file["swath"].id).addr
    if other == "damaged":
        whole = bytearray((tmp_path / "line.h5").read_bytes())
        whole[place + 10] ^= 0x55
        (tmp_path / "line.h5").write_bytes(whole)
    reason = {"cube": "swath has another number of dimensions", "damaged": "swath cannot be opened"}
    scene = write_scene(tmp_path, "line.h5")
    for array in ([], ["--set", "input.array=swath"]):
        assert_refused(sonject("run", scene, "-o", "out", *array), 3, reason.get(other, "swath is of a type"))
    with h5py.File(tmp_path / "line.h5", "a") as file:
        file["mask"] = (swath > numpy.median(swath)).astype("u1")
    assert_refused(sonject("run", scene, "-o", "out"), 3, "choose one by its key array (input.array)",
                   "mask (96 x 128), swath (cannot be read)")
    sonject.done("run", scene, "-o", "out", "--set", "input.array=mask")


def test_of_matlab_5_arrays_none_is_taken_for_another(sonject, tmp_path, swath):
    whole = (swath * 100).astype("i4")
    mask = (swath * 100).astype("u1")
    scene = write_scene(tmp_path, "line.mat")
    scipy_io.savemat(tmp_path / "line.mat", {"swath": whole, "mask": mask})
    assert_refused(sonject("run", scene, "-o", "out"), 3, "swath (cannot be read), mask (96 x 128)")
    scipy_io.savemat(tmp_path / "line.mat", {"swath": whole})
    assert_refused(sonject("run", scene, "-o", "out"), 3, "swath is of numbers that sonject does not read")
    scipy_io.savemat(tmp_path / "line.mat", {"swath": whole.reshape(2, 48, 128)})
    assert_refused(sonject("run", scene, "-o", "out"), 3, "swath has more than two dimensions")


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_a_logical_array_is_no_swath(sonject, tmp_path, swath, version):
    scene = write_scene(tmp_path, "line.mat")
    if version == "5":
        scipy_io.savemat(tmp_path / "line.mat", {"mask": swath > numpy.median(swath)})
    else:
        with h5py.File(tmp_path / "line.mat", "w") as file:
            file["mask"] = (swath > numpy.median(swath)).T.astype("u1")
            file["mask"].attrs["MATLAB_class"] = numpy.bytes_("logical")
    assert_refused(sonject("run", scene, "-o", "out"), 3, "holds no two-dimensional array of numbers")
    if version == "5":
        scipy_io.savemat(tmp_path / "line.mat", {"mask": swath > numpy.median(swath), "swath": swath})
    else:
        with h5py.File(tmp_path / "line.mat", "a") as file:
            file["swath"] = swath.T
            file["swath"].attrs["MATLAB_class"] = numpy.bytes_("single")
    sonject.done("run", scene, "-o", "out")


def test_a_campaign_takes_each_swath_from_its_array(sonject, tmp_path, swath):
    sides = {"port": swath, "sides/starboard": swath[::-1]}
    with h5py.File(tmp_path / "line.h5", "w") as file:
        for name, side in sides.items():
            file[name] = side
    (tmp_path / "scene.yaml").write_text(SCENE.replace("  path: swath.tif\n", "")
                                         .split("objects:")[0])
    swaths = ", ".join(f"{{path: line.h5, set: {{input.array: {name}}}}}" for name in sides)
    (tmp_path / "campaign.yaml").write_text(
        "sonject_campaign: 1\nscene: scene.yaml\nimages: 4\nempty: 1\n"
        f"chip: {{rows: 32, columns: 48}}\nswaths: [{swaths}]\n")
    sonject.done("campaign", "campaign.yaml", "-o", "set")
    taken = []
    for path in sorted((tmp_path / "set").glob("all/records/*.json")):
        record = json.loads(path.read_text())
        name = next(text.split("=")[1].strip('"') for text in record["set"] if text.startswith("input.array"))
        row, column = (record["swath"][key] for key in ("row", "column"))
        chip = images.read_tiff(tmp_path / "set/all" / record["image"])
        assert numpy.array_equal(chip, sides[name][row : row + 32, column : column + 48])
        taken.append(name)
    assert sorted(taken) == ["port", "port", "sides/starboard", "sides/starboard"]
