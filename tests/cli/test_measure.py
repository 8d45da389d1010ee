"""Tests of sonject measure, which prints an image's statistics as JSON."""

import json
import re

import numpy
import pytest

import recordings
from conftest import assert_refused, write_text
from images import png_bytes, read_tiff, tiff_bytes
from measured_images import read_png

ROWS, COLUMNS = 256, 320


def speckle(looks=1, seed=1):
    random = numpy.random.default_rng(seed)
    return numpy.sqrt(random.gamma(looks, 0.01 / looks, (ROWS, COLUMNS))).astype(numpy.float32)


def write(path, pixels):
    path.write_bytes(tiff_bytes(pixels))
    return path.name


def write_scene(folder, source, ball, first_range=30, more=""):
    write_text(folder, source, f"row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: {first_range} m",
               f"{{name: ball, shape: sphere, {ball}}}", more=more)


def told(answer):
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def test_arrays_are_measured_as_images_are(sonject, tmp_path):
    mask = numpy.zeros((ROWS, COLUMNS), numpy.uint8)
    mask[90:170, 100:220] = 255
    bed = speckle()
    numpy.save(tmp_path / "bed.npy", bed)
    numpy.save(tmp_path / "mask.npy", mask)
    (tmp_path / "mask.png").write_bytes(png_bytes(mask))
    of_image = told(sonject("measure", write(tmp_path / "bed.tif", bed), "--targets", "mask.png"))
    assert told(sonject("measure", "bed.npy", "--targets", "mask.npy")) == of_image
    bed[mask > 0] = 1  # masked pixels do not count
    assert told(sonject("measure", write(tmp_path / "other.tif", bed), "--targets", "mask.png")) == of_image
    assert told(sonject("measure", "other.tif")) != of_image


def test_speckle_is_measured_and_transfer_undone(sonject, tmp_path):
    """The speckle has 3 looks. Each of 80 blocks of 1024 values gives the squared intensity contrast to
    sqrt(20 / 1024) / 3. Their median has 1.25 / sqrt(80) of that error: 2 %."""
    write(tmp_path / "bed.tif", speckle(3))
    write(tmp_path / "decibels.tif", (20 * numpy.log10(speckle(3))).astype(numpy.float32))
    plain = told(sonject("measure", "bed.tif"))["seabed"]
    for name, value in {"amplitude_contrast": 0.2940, "intensity_contrast": 3**-0.5, "looks": 3}.items():
        assert plain[name] == pytest.approx(value, rel=0.08 if name == "looks" else 0.04), name
    assert max(abs(plain["row_correlation"]), abs(plain["column_correlation"])) < 0.03
    undone = told(sonject("measure", "decibels.tif", "--transfer", "decibel:1"))["seabed"]
    for name, value in plain.items():
        assert undone[name] == pytest.approx(value, rel=1e-3, abs=1e-3), name


def test_channels_are_measured_as_images_are(sonject, tmp_path):
    sides = [numpy.round(2e4 * speckle(looks, seed=looks)).astype(numpy.uint16) for looks in (1, 2)]
    for side, pixels in zip(("port", "starboard"), sides):
        pixels[40:44, 60:80] = 60000
        write(tmp_path / f"{side}.tif", pixels)
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides))
    for side, options in (("port", []), ("starboard", []), ("port", ["--box", "30,40,40,80"])):
        channel = told(sonject("measure", *options, "line.xtf", "--channel", side))
        image = told(sonject("measure", *options, f"{side}.tif"))
        for contact in channel.get("contacts", []) + image.get("contacts", []):
            for key in [key for key in contact if key == "image" or key.endswith("_m") or key.startswith("axis_")]:
                del contact[key]  # only the recording gives metres
        assert channel == image
    for code, words, arguments in (
            (3, ["line.xtf", "1 (port), 2 (starboard)"], ["line.xtf"]),
            (3, ["neither XTF nor JSF"], ["port.tif", "--channel", "port"]),
            (3, ["absent.xtf: "], ["absent.xtf", "--channel", "port"]),
            (2, ["--channel"], ["line.xtf", "--channel", "left"])):
        assert_refused(sonject("measure", *arguments), code, *words)


def test_images_that_do_not_fit(sonject, tmp_path):
    write(tmp_path / "image.tif", speckle())
    write(tmp_path / "small.tif", speckle()[:-1])
    bad = speckle()
    bad[3, 4] = numpy.nan
    write(tmp_path / "bad.tif", bad)
    assert_refused(sonject("measure", "absent.tif"), 3, "absent.tif")
    assert_refused(sonject("measure", "bad.tif"), 3, "row 3, column 4")
    assert_refused(sonject("measure", "image.tif", "--targets", "small.tif"), 3, "small.tif", "255 x 320")
    assert_refused(sonject("measure", "image.tif", "--transfer", "schlick:0.5"), 3, "parameter")


def test_steps_of_grey_are_kept(sonject, tmp_path):
    """Eight bits in a file of sixteen stay multiples of 256, also in a run with a target."""
    grey = numpy.clip(speckle() * 600, 0, 200).astype(numpy.uint16) * 256
    write(tmp_path / "swath.tif", grey)
    write_scene(tmp_path, "path: swath.tif", "diameter: 0.5 m, level: {over_seabed: 12 dB}", 40)
    sonject.done("run", "scene.yaml", "-o", "out", "--quiet")
    after = numpy.frombuffer((tmp_path / "out" / "image.tif").read_bytes(), "<u2", grey.size, 8)
    changed = after.reshape(grey.shape) != grey
    assert changed.sum() > 200
    assert not (after % 256).any()
    truth = json.loads((tmp_path / "out" / "truth.json").read_text())
    level = truth["objects"][0]["level"]
    assert level["set_by"] == "over_seabed" and level["asked_db"] == 12
    assert level["over_seabed_db"] == pytest.approx(12, abs=1e-4)
    assert truth["blending"]["seabed_estimated"]["looks"] >= 1
    run = json.loads((tmp_path / "out" / "run.json").read_text())
    assert run["blending"] == truth["blending"]


# Highlight and shadow (row, column, rows, columns). Their sides differ, and they lie off the middle.
HIGHLIGHT, SHADOW = (70, 150, 21, 12), (70, 162, 21, 55)


def contact(seed=1, shadow_columns=55):
    pixels = speckle(seed=seed)
    row, column, rows, columns = HIGHLIGHT
    pixels[row : row + rows, column : column + columns] *= 6
    row, column, rows, _ = SHADOW
    pixels[row : row + rows, column : column + shadow_columns] *= 0.05
    return pixels


def test_lengths_of_a_contact(sonject, tmp_path):
    """Means over 12 or more rows or columns show sharp edges in speckle to a pixel or two."""
    write(tmp_path / "image.tif", contact())
    spacing = ["--row-spacing", "0.1", "--column-spacing", "0.05"]
    box = "60,140,41,90"
    (told_by_box,) = told(sonject("measure", "image.tif", "--box", box, *spacing))["contacts"]
    for part, (row, column, rows, columns) in (("highlight", HIGHLIGHT), ("shadow", SHADOW)):
        for name, size, metres in (("along", rows, 0.1), ("range", columns, 0.05)):
            assert told_by_box[f"{part}_{name}_pixels"] == pytest.approx(size, abs=1.5)
            assert told_by_box[f"{part}_{name}_m"] == pytest.approx(
                told_by_box[f"{part}_{name}_pixels"] * metres)
        near = told_by_box[f"{part}_box"]
        assert abs(near["row"] - row) <= 2 and abs(near["rows"] - rows) <= 4
        assert abs(near["column"] - column) <= 2 and abs(near["columns"] - columns) <= 4
    # 36 times the seabed's energy, and 1/400 of it; 252 and 1155 single-look values
    assert told_by_box["highlight_contrast_db"] == pytest.approx(15.6, abs=1.0)
    assert told_by_box["shadow_contrast_db"] == pytest.approx(-26.0, abs=1.0)
    assert told_by_box["seabed_db"] == pytest.approx(-20.0, abs=0.5)
    assert told_by_box["axis_length_m"] == pytest.approx(2.1, abs=0.3)
    assert told_by_box["axis_width_m"] == pytest.approx(0.6, abs=0.15)
    truth = {"objects": [{"box": {"row": 70, "column": 150, "rows": 21, "columns": 67,
                                  "length_m": 2.1, "width_m": 3.35}}, {"box": None}]}
    (tmp_path / "truth.json").write_text(json.dumps(truth))
    (by_truth,) = told(sonject("measure", "image.tif", "--truth", "truth.json"))["contacts"]
    assert by_truth["shadow_range_m"] == pytest.approx(told_by_box["shadow_range_m"], abs=0.05)
    truth["objects"][0]["box"]["columns"] = 1000
    (tmp_path / "truth.json").write_text(json.dumps(truth))
    assert_refused(sonject("measure", "image.tif", "--truth", "truth.json"), 3, "truth.json")
    for bad in ("250,0,10,10", "0,0,10,321", f"{2**64 - 1},0,1,1"):
        assert_refused(sonject("measure", "image.tif", "--box", bad), 3, "box")
    for bad in ("1,2,3", "1,2,0,4", "1,2,3,4,5", "-1,2,3,4"):
        assert_refused(sonject("measure", "image.tif", f"--box={bad}"), 2, "--box")


def test_numbers_that_cannot_be_measured(sonject, tmp_path):
    pixels = speckle()
    pixels[3, 4] = 3e19
    write(tmp_path / "image.tif", pixels)
    assert_refused(sonject("measure", "image.tif"), 3, "row 3, column 4", "scale")
    assert_refused(sonject("measure", "image.tif", "--box", "0,0,40,40"), 3, "row 3, column 4", "scale")
    write(tmp_path / "image.tif", speckle())
    for key, value in (("length_m", -1.0), ("width_m", 1e300)):
        box = {"row": 70, "column": 150, "rows": 21, "columns": 67, "length_m": 2, "width_m": 3}
        truth = {"objects": [{"box": {**box, key: value}}]}
        (tmp_path / "truth.json").write_text(json.dumps(truth))
        assert_refused(sonject("measure", "image.tif", "--truth", "truth.json"), 3, "lengths")


@pytest.mark.parametrize("change, note", [
    ("diameter: 10 cm, burial: 8 cm, level: {over_seabed: 1 dB}", "'ball' cannot be seen: neither its highlight"),
    ("diameter: 60 cm, level: {over_seabed: 0 dB}", "the highlight of 'ball' does not stand out from the seabed"),
    ("diameter: 30 cm, burial: 40 cm", "nothing of 'ball' is in view"), ("diameter: 30 cm", None),
    ("diameter: 60 cm, level: {over_seabed: 30 dB}, position: {row: 64, column: 8}", "its level counts for the part in view")])
def test_a_run_notes_what_nobody_would_see(sonject, tmp_path, change, note):
    write_scene(tmp_path, "synthetic: {rows: 128, columns: 128, seed: 3}",
                change if "position" in change else f"{change}, position: {{row: 64, column: 64}}")
    notes = [line for line in sonject.done("run", "scene.yaml", "-o", "out").stderr.splitlines() if "note: " in line]
    assert len(notes) == (note is not None) and all(note in line for line in notes)


ROUGH = "diameter: 60 cm, material: {reflection: 0, lambert: 0.1}, position: {row: 80, column: 80}"


def test_a_seabed_near_the_ceiling_is_told_once(sonject, tmp_path):
    swath = numpy.random.default_rng(6).rayleigh(300, (128, 128))
    write(tmp_path / "swath.tif", numpy.minimum(swath, 255).astype(numpy.uint8))
    write_scene(tmp_path, "path: swath.tif, transfer: {kind: amplitude}", "level: {over_seabed: 6 dB}, " + ROUGH)
    notes = sonject.done("run", "scene.yaml", "-o", "out").stderr
    assert re.search("no highlight of 'ball' can stand out: the seabed there is [0-9.]+ dB below the image's ceiling", notes)
    assert "raise" not in notes and "would leave room" not in notes


@pytest.mark.parametrize("level, ceiling, stored", [
    (24, 255, numpy.uint8), (24, 200, numpy.uint8), (24, 15, numpy.uint8), (10, 255, numpy.uint8),
    (24, None, numpy.float32)])
def test_highlights_at_the_ceiling_are_told(sonject, tmp_path, level, ceiling, stored):
    """The ceiling is the file's largest number, or a lower one that the picture keeps. Floats have none."""
    swath = numpy.random.default_rng(6).rayleigh(2 if ceiling == 15 else 30, (128, 128))
    transfer = f", transfer: {{kind: amplitude, full_scale: {ceiling}}}" if ceiling == 15 else ""
    if ceiling == 200:
        swath[:40, :40] = 200
    write(tmp_path / "swath.tif", numpy.minimum(swath, ceiling or swath).astype(stored))
    write_scene(tmp_path, f"path: swath.tif{transfer}", f"level: {{over_seabed: {level} dB}}, {ROUGH}")
    notes = sonject.done("run", "scene.yaml", "-o", "out").stderr
    (ball,) = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"]
    image = read_tiff(tmp_path / "out" / "image.tif")
    highlight = read_png(tmp_path / "out" / "highlight.png") > 0
    share = (image[highlight] == (ceiling or numpy.inf)).mean()
    assert ball["highlight_clipped"] == pytest.approx(share, abs=1e-9)
    assert (share > 0.1) == (level == 24 and ceiling is not None) == ("at the image's ceiling" in notes)
    room = ball["level"]["ceiling_over_seabed_db"]
    if ceiling is None:
        assert room is None
        return
    if ceiling == 255:  # 0.5 dB are 5 standard errors of 1600 squares of speckle
        around = (numpy.minimum(swath, 255)[60:100, 60:100] ** 2).mean()
        assert room == pytest.approx(10 * numpy.log10(255**2 / around), abs=0.5)
    if share > 0.1:
        told = float(re.search(r"{over_seabed: (-?\d+) dB} would leave room", notes)[1])
        assert room - 4 < told <= room - 3
        lower = sonject.done("run", "scene.yaml", "-o", "lower", "--set", f"objects[0].level={{over_seabed: {told} dB}}")
        assert "at the image's ceiling" not in lower.stderr


def test_the_water_column_is_nobodys_seabed(sonject, tmp_path):
    """The water column, within 24 pixels of the target and up to column 40, would drown every shadow."""
    swath = numpy.random.default_rng(5).rayleigh(30, (128, 160))
    swath[:, :40] = 1
    write(tmp_path / "swath.tif", swath.astype(numpy.float32))
    write_scene(tmp_path, "path: swath.tif", "diameter: 60 cm, position: {row: 64, column: 60}", 9,
                "injection: {noise_floor: -25 dB}\n")
    sonject.done("run", "scene.yaml", "-o", "out")
    (ball,) = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"]
    assert ball["shadow"]["column"] < 40 + 24 and ball["shadow_visibility_db"] < -6


def test_negative_amplitudes_are_refused(sonject, tmp_path):
    """Their magnitudes would be measured, and those of numbers in dB mean nothing."""
    decibels = numpy.random.default_rng(1).normal(-40, 5, (64, 64)).astype(numpy.float32)
    decibels[0, 0] = 3
    (tmp_path / "decibels.tif").write_bytes(tiff_bytes(decibels))
    assert_refused(sonject("measure", "decibels.tif"), 3, "decibels.tif: the pixel at row 0, column 1 is a negative amplitude")
    sonject.done("measure", "decibels.tif", "--transfer", "decibel:1")
