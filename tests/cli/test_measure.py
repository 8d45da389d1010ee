"""sonject measure: an image's statistics as JSON."""

import json

import numpy
import pytest

from conftest import assert_refused
from images import png_bytes, tiff_bytes

ROWS, COLUMNS = 256, 320


def speckle(looks=1, seed=1):
    random = numpy.random.default_rng(seed)
    return numpy.sqrt(random.gamma(looks, 0.01 / looks, (ROWS, COLUMNS))).astype(numpy.float32)


def write(path, pixels):
    path.write_bytes(tiff_bytes(pixels))
    return path.name


def told(answer):
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def test_statistics_of_speckle(sonject, tmp_path):
    """Uncorrelated speckle of 1 and 3 looks: 80 blocks of 1024 values know the squared intensity
    contrast to sqrt(20 / 1024) / looks, their median to 1.25 / sqrt(80) of that: 2 %."""
    for looks, amplitude_contrast in ((1, 0.5227), (3, 0.2940)):
        seabed = told(sonject("measure", write(tmp_path / "bed.tif", speckle(looks))))["seabed"]
        assert seabed["amplitude_contrast"] == pytest.approx(amplitude_contrast, rel=0.04)
        assert seabed["intensity_contrast"] == pytest.approx(looks**-0.5, rel=0.04)
        assert seabed["looks"] == pytest.approx(looks, rel=0.08)
        assert seabed["row_correlation"] < 0.03 and seabed["column_correlation"] < 0.03


def test_transfer_is_undone(sonject, tmp_path):
    write(tmp_path / "bed.tif", speckle())
    write(tmp_path / "decibels.tif", (20 * numpy.log10(speckle())).astype(numpy.float32))
    plain = told(sonject("measure", "bed.tif"))["seabed"]
    undone = told(sonject("measure", "decibels.tif", "--transfer", "decibel:1"))["seabed"]
    for name, value in plain.items():
        assert undone[name] == pytest.approx(value, rel=1e-3, abs=1e-3), name


def test_seam(sonject, tmp_path):
    before = speckle()
    after = before.copy()
    mask = numpy.zeros((ROWS, COLUMNS), numpy.uint8)
    mask[90:170, 100:220] = 255
    after[mask > 0] = speckle(2, seed=5)[mask > 0]
    write(tmp_path / "before.tif", before)
    write(tmp_path / "after.tif", after)
    (tmp_path / "mask.png").write_bytes(png_bytes(mask))
    by_mask = told(sonject("measure", "--seam", "after.tif", "--influence", "mask.png"))["seam"]
    assert by_mask["auc"] > 0.7 and 0 < by_mask["standard_error"] < 0.2
    assert by_mask["auc_before"] is None
    by_image = told(sonject("measure", "--seam", "after.tif", "--before", "before.tif"))["seam"]
    assert by_image["auc"] > 0.7
    assert abs(by_image["auc_before"] - 0.5) < 4 * by_image["standard_error"]
    none = told(sonject("measure", "--seam", "before.tif", "--influence", "mask.png"))["seam"]
    assert abs(none["auc"] - 0.5) < 4 * none["standard_error"]
    hidden = told(sonject("measure", "--seam", "after.tif", "--influence", "mask.png", "--targets",
                          "mask.png"))["seam"]
    assert hidden["auc"] is None and hidden["patches"] == 0


def test_images_that_do_not_fit(sonject, tmp_path):
    write(tmp_path / "image.tif", speckle())
    write(tmp_path / "small.tif", speckle()[:-1])
    bad = speckle()
    bad[3, 4] = numpy.nan
    write(tmp_path / "bad.tif", bad)
    assert_refused(sonject("measure", "absent.tif"), 3, "absent.tif")
    assert_refused(sonject("measure", "bad.tif"), 3, "row 3, column 4")
    assert_refused(sonject("measure", "--seam", "image.tif", "--before", "small.tif"), 3,
                   "small.tif", "255 x 320")
    assert_refused(sonject("measure", "--seam", "image.tif", "--influence", "small.tif"), 3,
                   "small.tif", "255 x 320")
    assert_refused(sonject("measure", "image.tif", "--transfer", "schlick:0.5"), 3, "parameter")


def test_steps_of_grey_are_kept(sonject, tmp_path):
    """Eight bits in a file of sixteen stay multiples of 256, in a run with a target too."""
    grey = numpy.clip(speckle() * 600, 0, 200).astype(numpy.uint16) * 256
    write(tmp_path / "swath.tif", grey)
    (tmp_path / "scene.yaml").write_text(
        "sonject: 1\n"
        "input:\n"
        "  path: swath.tif\n"
        "  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 40 m}\n"
        "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}\n"
        "objects:\n"
        "  - {shape: sphere, diameter: 0.5 m, level: {over_seabed: 12 dB}}\n")
    answer = sonject("run", "scene.yaml", "-o", "out", "--quiet")
    assert answer.returncode == 0, answer.stderr
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
