"""Tests of unusable scenes and images: exit code 3, one line for each mistake, nothing written."""

import os
import struct

import numpy
import pytest

import images
from conftest import COLUMNS, ROWS, assert_refused, files_below


def refuse(sonject, scene, code, *words, options=()):
    """Asserts that check and run refuse the scene and leave no files behind."""
    before = files_below(scene.parent)
    assert_refused(sonject("check", scene, *options), code, *words)
    assert_refused(sonject("run", scene, "-o", "result", *options), code, *words)
    assert files_below(scene.parent) == before


def edit(scene, old, new):
    text = scene.read_text()
    assert text.count(old) == 1
    scene.write_text(text.replace(old, new))


OUTPUTS = {"check": [], "measure": [], "convert": ["b.npy"], "quicklook": ["-o", "b.png"]}


def test_what_may_never_end_is_refused_at_once(sonject, scene, tmp_path):
    for name in ("pipe", "pipe.stl"):
        os.mkfifo(tmp_path / name)
    for verb in (*OUTPUTS, "run", "trace", "elements", "form", "campaign"):
        for name in ("pipe", "/dev/zero"):
            answer = sonject(verb, name, *OUTPUTS.get(verb, ["-o", "result"]), timeout=60)
            assert_refused(answer, 3, name, "not a regular file")
    for named in (
            "input.path=pipe", "sonar.measured_response=pipe", "sonar.motion.file=pipe",
            "medium.profile.file=pipe", "objects=[{target: pipe}]",
            "objects=[{shape: mesh, mesh: pipe.stl}]",
            "seabed.relief=[{heights: {file: pipe, unit: m, row_spacing: 1 m, column_spacing: 1 m, "
            "first_ground_range: 1 m}}]"):
        answer = sonject("check", scene, "--set", named, timeout=60)
        assert_refused(answer, 3, "pipe", "not a regular file")


MISTAKES = [
    ("first_slant_range: 25 m", "first_slant_range: 5 m", ["altitude"]),  # nearer than the altitude
    ("  path: swath.tif", "  path: swath.tif\n  complex: true", ["swath.tif", "channel"]),
    ("objects:", f"patch: {{row: 0, column: 100, rows: {ROWS}, columns: 64}}\nobjects:",
     ["patch", str(COLUMNS)]),
]


@pytest.mark.parametrize("old, new, words", MISTAKES)
def test_a_mistake_is_told_with_its_place(sonject, scene, old, new, words):
    edit(scene, old, new)
    refuse(sonject, scene, 3, *words)


IMAGES = {
    "none at all": lambda swath: b"this is no image\n" * 100,
    "a few bytes": lambda swath: images.tiff_bytes(swath)[:4],
    "no directory": lambda swath: images.tiff_bytes(swath)[:100],
    "half of the pixels": lambda swath: images.tiff_bytes(swath)[: ROWS * COLUMNS * 2],
    "of astronomic size": lambda swath: images.tiff_bytes(swath, width=2**31 - 1, height=2**31 - 1),
}


def test_images_and_scenes_that_are_not_there_or_damaged(sonject, scene, swath):
    path = scene.parent / "swath.tif"
    path.unlink()
    refuse(sonject, scene, 3, "swath.tif")
    for make in IMAGES.values():
        path.write_bytes(make(swath))
        refuse(sonject, scene, 3, "swath.tif")
    for content in (b"sonar: [1, 2\nobjects: }\n", b"", bytes(range(256)) * 16):
        scene.write_bytes(content)
        refuse(sonject, scene, 3, "scene.yaml")
    scene.unlink()
    refuse(sonject, scene, 3, "scene.yaml")


@pytest.mark.parametrize("words", [
    ("run", "scene.yaml", "-o", "."), ("run", "shadow.yaml", "-o", "."), ("trace", "scene.yaml", "-o", "image.tif"),
    ("convert", "image.tif", "image.tif", "--db=-40:0"), ("convert", "image.tif", "twin.tif", "--into", "twin.tif"),
    ("calibrate", "image.tif", "--picture", "image.tif"),
    ("calibrate", "image.tif", "-o", "linked.tif"), ("quicklook", "shadow.png", "-o", "shadow.png")])
def test_no_result_replaces_the_image_that_was_read(sonject, scene, tmp_path, words):
    (tmp_path / "swath.tif").rename(tmp_path / "image.tif")
    (tmp_path / "linked.tif").symlink_to("image.tif")
    edit(scene, "path: swath.tif", "path: image.tif")
    sonject.done("convert", "image.tif", "shadow.png", "--db=-40:0")
    (tmp_path / "shadow.yaml").write_text(scene.read_text().replace(
        "path: image.tif", "path: shadow.png\n  transfer: {kind: decibel, parameter: 0.157, offset: -40}"))
    sonject.done("convert", "image.tif", "twin.tif")
    before = {name: (tmp_path / name).read_bytes() for name in ("image.tif", "shadow.png", "twin.tif")}
    answer = sonject(*words)
    assert answer.returncode == 2 and "is the image that was read, and no result replaces it" in answer.stderr
    assert {name: (tmp_path / name).read_bytes() for name in before} == before
    assert not list(tmp_path.glob("*.part*"))


def test_every_verb_tells_all_mistakes_in_their_order(sonject, scene):
    edit(scene, "100 kHz", "100 parsec")
    edit(scene, "column_spacing: 2.5 cm", "colum_spacing: 2.5 cm")
    edit(scene, "shape: sphere", "shape: shpere")
    for verb in (["check"], ["run", "-o", "result"], ["trace", "-o", "x.sums"]):
        answer = sonject(verb[0], scene, *verb[1:], "--set", "sonar.altitude=deep")
        assert_refused(answer, 3, "scene.yaml:6:5: input.geometry.colum_spacing", mistakes=4)
        assert [line.split(": ")[2] for line in answer.stderr.splitlines()] == [
            "input.geometry.colum_spacing", "sonar.frequency", "objects[0].shape",
            "'deep' is not a number with a unit of m, km, cm, mm"]


WRONG_PLACES = """
  - shape: sphere
    diameter: 0.5 m
    position: {row: 2, column: 9000}
  - {shape: sphere, diameter: 0.5 m, burial: {proud: 0.9 m}}
  - {shape: sphere, diameter: 7.4 mm}
  - {shape: sphere, diameter: 900 m}
"""


def test_all_objects_that_do_not_fit_are_told_with_their_places(sonject, scene):
    lines = len(scene.read_text().splitlines())
    scene.write_text(scene.read_text() + WRONG_PLACES.lstrip("\n"))
    count = scene.read_text()[:scene.read_text().index(WRONG_PLACES.lstrip("\n"))].count("shape:")
    told = [(f"scene.yaml:{lines + 3}:15", f"objects[{count}].position", "lies outside the patch"),
            (f"scene.yaml:{lines + 4}:46", f"objects[{count + 1}].burial", "0.900 m proud"),
            (f"scene.yaml:{lines + 5}:5", f"objects[{count + 2}]", "half the wavelength of 15 mm"),
            (f"scene.yaml:{lines + 6}:5", f"objects[{count + 3}]", "larger than the patch")]
    for verb in (["check"], ["run", "-o", "result"]):
        answer = sonject(verb[0], scene, *verb[1:])
        assert_refused(answer, 3, *told[0], mistakes=4)
        for line, words in zip(answer.stderr.splitlines(), told):
            assert [word in line for word in words] == [True] * 3, line


def test_more_mistakes_than_a_message_holds_are_announced(sonject, scene):
    scene.write_text(scene.read_text() + "  - {shape: sphere, diameter: 900 m}\n" * 120)
    lines = sonject("check", scene).stderr.splitlines()
    assert 30 < len(lines) < 120 and lines[-1] == "sonject: and more"
    assert all("larger than the patch" in line for line in lines[:-1])


def test_what_the_image_refuses_has_a_place(sonject, scene):
    refuse(sonject, scene, 3, "--set patch: ", "not inside the image",
           options=["--set", "patch={rows: 1, columns: 9000}"])
    edit(scene, "path: ", "path: no/")
    line = [number for number, text in enumerate(scene.read_text().splitlines(), 1)
            if "no/" in text][0]
    refuse(sonject, scene, 3, f"scene.yaml:{line}:", "input.path: ", "swath.tif")


def test_an_image_whose_pixels_are_cut_short(sonject, scene, swath):
    # The directory stands before the pixels, so only reading the pixels shows that they are cut.
    content = images.tiff_bytes(swath)
    (start,) = struct.unpack_from("<I", content, 4)
    directory = bytearray(content[start:])
    for index in range(struct.unpack_from("<H", directory)[0]):
        place = 2 + 12 * index
        if struct.unpack_from("<H", directory, place) == (273,):
            struct.pack_into("<I", directory, place + 8, 8 + len(directory))
    moved = content[:4] + struct.pack("<I", 8) + bytes(directory) + content[8:start]
    (scene.parent / "swath.tif").write_bytes(moved[: len(moved) // 2])
    before = files_below(scene.parent)
    assert_refused(sonject("run", scene, "-o", "result"), 3, "swath.tif")
    assert files_below(scene.parent) == before


@pytest.mark.parametrize("value", [numpy.nan, numpy.inf, -1.0])
def test_pixels_that_are_no_amplitudes(sonject, scene, swath, value):
    swath[40, 50] = value
    (scene.parent / "swath.tif").write_bytes(images.tiff_bytes(swath))
    before = files_below(scene.parent)
    assert_refused(sonject("run", scene, "-o", "result"), 3, "swath.tif", "40", "50")
    assert files_below(scene.parent) == before


def test_a_seabed_beyond_all_sizes(sonject, tmp_path):
    answer = sonject("seabed", "-o", "x.tif", "--rows", 2**31)
    assert answer.returncode in (2, 3)
    assert len(answer.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


WARM_BOTTOM = """\
sonject: 1
input:
  uniform: {rows: 200, columns: 300}
  geometry: {row_spacing: 5 cm, column_spacing: 2.5 cm, first_slant_range: 30 m}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m, aperture: none}
medium:
  profile: {heights: [0, 1, 2, 4, 7, 10.5], sound_speeds: [1530, 1511, 1504, 1500.5, 1500, 1500]}
objects:
  - {shape: box, length: 2 m, width: 0.5 m, height: 0.5 m, material: steel}
"""


def test_sound_that_turns_back_beside_an_object_is_told(sonject, tmp_path):
    (tmp_path / "warm.yaml").write_text(WARM_BOTTOM)
    answer = sonject("run", "warm.yaml", "-o", "result")
    assert_refused(answer, 3, "turns back", "smaller objects")
    answer = sonject("run", "warm.yaml", "-o", "small", "--set", "objects[0].length=0.4 m")
    assert answer.returncode == 0, answer.stderr
