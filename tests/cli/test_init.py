"""Tests of sonject init, which writes a first scene from an image and a few answers."""

import json
import os
import pathlib
import re
import shlex

import numpy
import pytest

import recordings
from made_swaths import COLUMNS, KINDS, LEVEL_DB, ROWS, Made
from measured_images import read_png

ANSWERS = ["5 cm", "2.5 cm", "44 m", "10 m", "100 kHz", "30 kHz", ""]


@pytest.fixture
def image(tmp_path):
    numpy.save(tmp_path / "swath.npy", Made("gamma").numbers)
    return tmp_path / "swath.npy"


def init(sonject, *arguments, answers):
    return sonject("init", *arguments, input="".join(f"{answer}\n" for answer in answers))


def start(sonject, *arguments, answers=ANSWERS):
    """Asserts that the answers make a scene."""
    answer = init(sonject, *arguments, answers=answers)
    assert answer.returncode == 0, answer.stderr
    return answer


def test_what_it_writes_runs(sonject, image):
    answer = start(sonject, "swath.npy")
    assert "object 1   cylinder (cylinder)" in answer.stdout
    scene = image.with_suffix(".yaml").read_text()
    for line in ('path: "swath.npy"', "row_spacing: 5 cm", "column_spacing: 2.5 cm", "first_slant_range: 44 m",
                 "altitude: 10 m", "frequency: 100 kHz", "bandwidth: 30 kHz"):
        assert f"  {line}" in scene
    assert "kind: real" not in scene
    assert "kind: gamma" in (image.parent / "swath_calibration.yaml").read_text()
    sonject.done("run", "swath.yaml", "-o", "out")
    assert (image.parent / "out" / "truth.json").exists()


def speckle(bits=None):
    """Returns complex speckle of power 1e-6, or its amplitudes as numbers of so many bits."""
    chance = numpy.random.default_rng(1)
    field = (chance.normal(size=(ROWS, COLUMNS)) + 1j * chance.normal(size=(ROWS, COLUMNS))) * 0.5**0.5 * 1e-3
    return field.astype(numpy.complex64) if bits is None else numpy.round(abs(field) * 2e6).astype(numpy.uint16)


def test_complex_pixels_make_a_scene(sonject, tmp_path):
    """The file says that its pixels are complex, so nobody need say it again."""
    numpy.save(tmp_path / "swath.npy", speckle())
    start(sonject, "swath.npy")
    assert "  complex: true # " in (tmp_path / "swath.yaml").read_text()
    sonject.done("run", "swath.yaml", "-o", "out")
    assert numpy.load(tmp_path / "out" / "image.npy").dtype == numpy.complex64


def test_a_campaign_draws_the_sizes_that_a_fit_moves(sonject, image):
    start(sonject, "swath.npy", "--campaign")
    sonject.done("campaign", "swath_campaign.yaml", "-o", "set", "--set", "images=6", "--set", "empty=0", "--set", "clutter.alone=0")
    truths = [json.loads(path.read_text())["objects"][0] for path in (image.parent / "set" / "all" / "truth").glob("*.json")]
    for size, (least, most) in {"length_m": (1.2, 1.9), "body_height_m": (0.4, 0.6)}.items():
        sizes = {truth[size] for truth in truths}
        assert len(sizes) == 6 and least <= min(sizes) < max(sizes) <= most


@pytest.mark.parametrize("bits", [None, 16])
def test_detectors_get_images_of_8_bits(sonject, tmp_path, bits):
    """The seabed, 35 dB over black, is neither black nor white."""
    numpy.save(tmp_path / "swath.npy", speckle(bits))
    start(sonject, "swath.npy", "--campaign")
    black, white = map(int, re.search(r"\ngrey: \[(-?\d+) dB, (-?\d+) dB\]", (tmp_path / "swath_campaign.yaml").read_text()).groups())
    sonject.done("campaign", "swath_campaign.yaml", "-o", "set", "--set", "images=2", "--set", "empty=1", "--set", "clutter.alone=0")
    for path in sorted((tmp_path / "set" / "all" / "images").iterdir()):
        seabed = numpy.median(read_png(path)) / 255 * (white - black)
        assert seabed == pytest.approx(35 - 1.6, abs=1.5)  # the median is 1.6 dB under the mean, and limits are rounded


@pytest.mark.parametrize("kind", ["amplitude", "gamma", "decibel"])
def test_the_picture_has_the_levels_of_the_measured_curve(sonject, tmp_path, kind):
    numpy.save(tmp_path / "swath.npy", Made(kind, share=1.0).numbers)
    start(sonject, "swath.npy")
    parameter = re.search(r"\n    parameter: (\S+)", (tmp_path / "swath_calibration.yaml").read_text())
    sonject.done("quicklook", "swath.npy", "-o", "expected.png", "--row-spacing", "5cm", "--column-spacing", "2.5cm", "--first-range",
                 "44m", "--transfer", f"{kind}:{parameter[1]}" if parameter else kind)
    assert (tmp_path / "swath_quicklook.png").read_bytes() == (tmp_path / "expected.png").read_bytes()


def test_a_wrong_answer_is_asked_for_again(sonject, image):
    answer = start(sonject, "swath.npy", answers=["", "5 xx", "-1 m", *ANSWERS])
    assert "unit 'xx' is not one of m, km, cm, mm" in answer.stderr and "must be" in answer.stderr
    assert "row_spacing: 5 cm" in image.with_suffix(".yaml").read_text()


def test_range_may_grow_to_the_left(sonject, image):
    """Shadows fall to the left, and the last column is the nearest."""
    start(sonject, "swath.npy", "--campaign", answers=["5 cm", "2.5 cm", "44 m left", *ANSWERS[3:]])
    scene = image.with_suffix(".yaml").read_text()
    for line in ("first_slant_range: 44 m", f"nadir_column: {COLUMNS - 1}", "side: port"):
        assert f"    {line} # " in scene
    assert "geometry.side" not in (image.parent / "swath_campaign.yaml").read_text()
    sonject.done("run", "swath.yaml", "-o", "out")
    (thing,) = json.loads((image.parent / "out" / "truth.json").read_text())["objects"]
    assert thing["shadow"]["column"] + thing["shadow"]["columns"] / 2 < thing["column"]
    assert thing["slant_range_m"] == pytest.approx(44 + 0.025 * (COLUMNS - 1 - thing["column"]), abs=0.05)


def test_a_water_column_at_the_right_is_no_second_side(sonject, tmp_path):
    """The image shows one side, whose range grows to the left. Its last column is the nearest."""
    numpy.save(tmp_path / "left.npy", Made("amplitude", water=numpy.full(ROWS, 120)).numbers[:, ::-1])
    answer = start(sonject, "left.npy", "--campaign", answers=["5 cm", "5 cm", "0 m left", "", "100 kHz", "30 kHz", ""])
    assert "side of the track" not in answer.stderr
    scene = (tmp_path / "left.yaml").read_text()
    for line in ("first_slant_range: 0 m", f"nadir_column: {COLUMNS - 1}", "side: port"):
        assert f"    {line} # " in scene
    assert (tmp_path / "left_campaign.yaml").read_text().count("- path: ") == 1


def test_a_nadir_that_was_not_found_can_be_answered(sonject, image):
    """The image shows no water column. Range grows to both sides of the column that is named."""
    answers = [*ANSWERS[:2], "foo left", f"nadir {COLUMNS}", "nadir x", f"nadir {COLUMNS // 3}.5", "port", "2 m", *ANSWERS[4:]]
    answer = start(sonject, "swath.npy", "--campaign", answers=answers)
    assert f"the answer 'nadir {COLUMNS}': the image has no columns" in answer.stderr and "the answer 'nadir x'" in answer.stderr
    scene = image.with_suffix(".yaml").read_text()
    for line in (f"nadir_column: {COLUMNS // 3}.5 # range grows to both sides", "side: port # of the nadir column"):
        assert f"    {line}\n" in scene
    assert "first_slant_range" not in scene
    campaign = (image.parent / "swath_campaign.yaml").read_text()
    assert "set: {input.geometry.side: port}" in campaign and "set: {input.geometry.side: starboard}" in campaign
    sonject.done("run", "swath.yaml", "-o", "out", "--set", "input.geometry.side=starboard")
    (thing,) = json.loads((image.parent / "out" / "truth.json").read_text())["objects"]
    assert thing["slant_range_m"] == pytest.approx(0.025 * (thing["column"] - COLUMNS // 3 - 0.5), abs=0.05)


def test_no_answer_leaves_no_file(sonject, image):
    answer = init(sonject, "swath.npy", answers=ANSWERS[:2])
    assert answer.returncode == 2 and "no answer was given for input.geometry.first_slant_range" in answer.stderr
    assert [path.name for path in image.parent.iterdir()] == ["swath.npy"]


@pytest.mark.parametrize("stem", ["[2] line", "line #3: a"])
def test_names_may_have_the_characters_of_yaml(sonject, image, stem):
    image.rename(image.parent / f"{stem}.npy")
    answer = init(sonject, f"{stem}.npy", "--campaign", answers=ANSWERS)
    assert answer.returncode == 0, answer.stderr
    sonject.done("run", f"{stem}.yaml", "-o", "out")
    sonject.done("check", f"{stem}_campaign.yaml")


@pytest.mark.parametrize("given", [("line\udcff.npy",), ("swath.npy", "--target", "line\udcff.npy"),
                                   ("swath.npy", "-o", "line\udcff.yaml")])
def test_names_that_are_not_utf8_are_refused_by_name(sonject, image, given):
    (image.parent / "line\udcff.npy").write_bytes(image.read_bytes())
    answer = init(sonject, *given, answers=ANSWERS)
    assert answer.returncode == 3 and re.search("init: the file name 'line.*' is not UTF-8 text: rename", answer.stderr)


def test_a_file_that_is_there_stays(sonject, image):
    image.with_suffix(".yaml").write_text("mine")
    answer = init(sonject, "swath.npy", answers=ANSWERS)
    assert answer.returncode == 3 and "swath.yaml: already exists" in answer.stderr
    assert image.with_suffix(".yaml").read_text() == "mine"


def test_an_array_makes_a_sidescan_and_the_scene_may_lie_elsewhere(sonject, image):
    (image.parent / "scenes").mkdir()
    start(sonject, "swath.npy", "-o", "scenes/mine.yaml", answers=[*ANSWERS[:-1], "0.5 m"])
    scene = (image.parent / "scenes" / "mine.yaml").read_text()
    assert "kind: real\n  array: {length: 0.5 m}" in scene and 'calibration: "mine_calibration.yaml"' in scene
    sonject.done("check", "scenes/mine.yaml")


def test_what_the_file_tells_is_not_asked_for(sonject, image):
    """The file tells a geometry without an altitude."""
    sonject.done("convert", "swath.npy", "swath.tif", "--row-spacing", "0.025", "--column-spacing", "0.025",
                 "--first-range", "44")
    start(sonject, "swath.tif", answers=ANSWERS[3:])
    scene = image.with_suffix(".yaml").read_text()
    assert "geometry: from_file" in scene and "altitude: 10 m" in scene


@pytest.mark.parametrize("typed", ["", "from_file"])
def test_a_recording_tells_the_geometry(sonject, tmp_path, typed):
    sides = [numpy.random.default_rng(7).rayleigh(2000.0, (120, 400)).astype(numpy.uint16) for _ in range(2)]
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=numpy.linspace(5.0, 9.0, 120)))
    answer = start(sonject, "line.xtf", "--channel", "port", answers=[typed, "600 kHz", "", "0.5 m"])
    assert "(from_file: as recorded, 7 m in the mean; or a number) [from_file]: " in answer.stderr
    scene = (tmp_path / "line.yaml").read_text()
    assert "bandwidth: 10 kHz # c / 2 divided by the column spacing" in scene  # 400 columns reach 30 m
    assert "channel: port" in scene and "geometry: from_file" in scene and "altitude: from_file" in scene


def test_an_answer_from_a_file_that_does_not_tell_it_is_asked_for_again(sonject, image):
    answer = start(sonject, "swath.npy", answers=[*ANSWERS[:3], "from_file", *ANSWERS[3:5], "", ""])
    assert "does not say the sonar's altitude: give it instead of from_file" in answer.stderr
    assert "bandwidth: 30 kHz # c / 2 divided by the column spacing" in image.with_suffix(".yaml").read_text()  # 2.5 cm


@pytest.mark.parametrize("share, level", [(1, 15), (0.35, None)])
def test_the_level_is_a_little_over_the_ceiling(sonject, tmp_path, share, level):
    """The level is the calibration's ceiling in whole dB, and 2 dB more since the place is darker than most."""
    made = Made("amplitude")
    numpy.save(tmp_path / "swath.npy", numpy.minimum(made.numbers, round(share * made.ceiling)))
    start(sonject, "swath.npy")
    found = json.loads(sonject.done("calibrate", "swath.npy", "--json").stdout)["measured"]["ceiling_over_seabed"]
    mean = 20 * numpy.log10(KINDS["amplitude"][1] / share)  # the seabed's level over full scale, dB
    assert found["value"] == pytest.approx(-mean, abs=4 * found["standard_error"] + LEVEL_DB / 4)
    told = float(re.search(r"level: {over_seabed: (\d+) dB}", (tmp_path / "swath.yaml").read_text())[1])
    assert told == (level or numpy.floor(found["value"] + 2)) <= 15


def test_altitude_by_first_returns_is_what_enter_takes(sonject, tmp_path):
    numpy.save(tmp_path / "swath.npy", Made("amplitude", water=numpy.full(ROWS, 120)).numbers)
    sonject.done("convert", "swath.npy", "swath.tif", "--row-spacing", "0.025", "--column-spacing", "0.025",
                 "--first-range", "0")
    answer = start(sonject, "swath.tif", answers=["", "100 kHz", "", ""])
    shown = float(re.search(r"\(first_return: from the first return of each ping, (\S+) m in the median; or a number\) \[first_return\]", answer.stderr)[1])
    assert shown == pytest.approx(120 * 0.025, rel=0.02)
    assert "altitude: first_return" in (tmp_path / "swath.yaml").read_text()
    assert float(re.search(r"altitude (\S+) m", answer.stdout)[1]) == pytest.approx(shown, rel=0.01)


# ---- Targets of the user's own, and campaigns.

def write_mesh(folder, side=400):
    """Writes a tetrahedron with coordinates in mm."""
    (folder / "rock.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in ((0, 0, 0), (side, 0, 0), (0, side, 0), (0, 0, side))) +
        "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")


ALTITUDE = 100 * 30 / COLUMNS  # m
OF_PORT = ("line.xtf", "--channel", "port", "--campaign")
PORT_ANSWERS = ["", "100 kHz", "30 kHz", ""]


def write_line(folder, change=lambda made: made.numbers, **options):
    """Writes both sides of a recording, each with a water column."""
    sides = [change(Made("amplitude", water=numpy.full(ROWS, 100), seed=seed)) for seed in (1, 2)]
    (folder / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=numpy.full(ROWS, ALTITUDE), **options))


@pytest.mark.parametrize("unit, why", [("m", " m, is larger than the patch"), ("mm", " mm large")])
def test_a_mesh_of_an_impossible_size_is_told_with_its_unit(sonject, image, unit, why):
    """A cone of 1000 or 1 units is no target in metres or in millimetres."""
    size = 1000 if unit == "m" else 1
    corners = [(0, 0), (size, 0), (size, size), (0, size)]
    faces = [(1, 5, 2), (2, 5, 3), (3, 5, 4), (4, 5, 1), (1, 2, 3), (1, 3, 4)]
    lines = [f"v {x} {y} 0" for x, y in corners] + [f"v {size / 2} {size / 2} {size / 2}"]
    (image.parent / "mine.obj").write_text("\n".join(lines + [f"f {a} {c} {b}" for a, b, c in faces]) + "\n")
    answer = init(sonject, "swath.npy", "--target", "mine.obj", answers=[*ANSWERS, unit, ""])
    assert answer.returncode == 3 and why in answer.stderr and "mesh.unit" in answer.stderr, answer.stderr
    assert sorted(path.name for path in image.parent.iterdir()) == ["mine.obj", "swath.npy"]
    start(sonject, "swath.npy", "--target", "mine.obj", answers=[*ANSWERS, "mm" if unit == "m" else "m", ""])


def test_a_mesh_and_a_campaign_of_both_sides(sonject, tmp_path):
    write_mesh(tmp_path)
    write_line(tmp_path)
    answer = start(sonject, "line.xtf", "--channel", "starboard", "--target", "rock.obj", "--campaign",
                  answers=["", "100 kHz", "30 kHz", "", "mm", "y"])
    assert "object 1   rock (mesh)" in answer.stdout and "0.4 x 0.4 x 0.4 m" in answer.stdout
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "line.xtf", "line.yaml", "line_calibration.yaml", "line_campaign.yaml", "line_port_calibration.yaml",
        "line_port_quicklook.png", "line_quicklook.png", "rock.obj"]
    text = (tmp_path / "line_campaign.yaml").read_text()
    assert 'set: {input.channel: starboard, input.calibration: "line_calibration.yaml"}' in text
    assert 'set: {input.channel: port, input.calibration: "line_port_calibration.yaml"}' in text
    assert re.search(r"^grey: \[-\d+ dB, -?\d+ dB\] ", text, flags=re.M)
    assert 'mesh: {file: "rock.obj", unit: mm, nose: y}' in text and "splits: {train: 0.5, val: 0.5}" in text
    for name, side in ("line", "starboard"), ("line_port", "port"):
        assert f"side: {side}\n" in (tmp_path / f"{name}_calibration.yaml").read_text()
    sonject.done("campaign", "line_campaign.yaml", "-o", "set", "--set", "images=20")
    notes = json.loads((tmp_path / "set" / "train" / "coco.json").read_text())
    assert {category["name"] for category in notes["categories"]} == {"rock", "stone"}


def test_a_line_where_nothing_clips_has_grey_levels_up_to_the_largest_number(sonject, tmp_path):
    random = numpy.random.default_rng(3)
    write_line(tmp_path, lambda made: numpy.where(
        made.numbers < made.ceiling, made.numbers, random.integers(20000, 50000, made.numbers.shape)))
    start(sonject, *OF_PORT, answers=PORT_ANSWERS)
    assert "  full_scale:\n    not_seen: " in (tmp_path / "line_calibration.yaml").read_text()
    grey = re.search(r"^grey: \[(-\d+) dB, 0 dB\] ", (tmp_path / "line_campaign.yaml").read_text(), flags=re.M)
    assert -70 < int(grey[1]) < -45  # 35 dB under the seabed


def test_the_pages_commands_make_a_data_set(sonject, tmp_path):
    """Runs all commands but the last, which needs scikit-learn: test_train_detector.py runs that one."""
    page = (pathlib.Path(os.environ["SONJECT_SOURCE"]) / "docs" / "first_detector.md").read_text()
    begin, run, calibrate, check, campaign, train = (shlex.split(line) for line in re.findall(r"^    (\w.*)", page, flags=re.M))
    write_mesh(tmp_path)
    (tmp_path / "rock.obj").rename(tmp_path / "my_mine.obj")
    write_line(tmp_path)
    begin = [word.replace("my_mine.stl", "my_mine.obj") for word in begin]
    start(sonject, *begin[2:], answers=["first_return", "600 kHz", "", "0.25 deg", "mm", ""])
    assert "array: {length: 0.508 m}" in (tmp_path / "line.yaml").read_text()  # 0.886 wavelengths over 0.25 degrees
    sonject.done(*run[1:])
    (tmp_path / "line_2.xtf").write_bytes((tmp_path / "line.xtf").read_bytes())
    sonject.done(*calibrate[1:])
    assert re.findall(r"line.xtf, (\w+): .* leave [1-9][0-9.]* % of the places", sonject.done(*check[1:]).stderr) == ["port", "starboard"]
    sonject.done(*campaign[1:], "--set", "images=10")
    for name in "line_quicklook.png", "line_starboard_quicklook.png", "one/report.html", "set/report.html", "set/data.yaml", "set/train/coco.json", "set/val/coco.json", train[2]:
        assert (tmp_path / name).exists()


def test_chips_hold_a_shadow_on_either_side(sonject, tmp_path):
    """Either side has room for 1.5 times the shadow of a cylinder of 0.5 m at three quarters of the range."""
    write_line(tmp_path)
    start(sonject, *OF_PORT, answers=PORT_ANSWERS)
    shadow = 0.75 * COLUMNS * 0.5 / (ALTITUDE - 0.5)  # in columns
    columns = int(re.search(r"columns: (\d+), spread", (tmp_path / "line_campaign.yaml").read_text())[1])
    assert columns % 32 == 0 and -2 <= columns - 3 * shadow < 34


def test_the_target_lies_where_the_seabed_is_plain_and_rather_dark(sonject, image):
    """The target lies at the calibration's place, which is further below the ceiling than the reported mean."""
    start(sonject, "swath.npy")
    row, column = map(int, re.search(r"position: {row: (\d+), column: (\d+)}", image.with_suffix(".yaml").read_text()).groups())
    assert COLUMNS / 3 <= column < 2 * COLUMNS / 3
    text = (image.parent / "swath_calibration.yaml").read_text()
    ceiling = float(re.search(r"ceiling_over_seabed:\n    value: (\S+)", text)[1])
    amplitude = (numpy.load(image) / Made("gamma").ceiling) ** KINDS["gamma"][0]
    mean = numpy.mean(amplitude[row - 16 : row + 16, column - 16 : column + 16] ** 2)
    assert ceiling + 0.25 * LEVEL_DB < -10 * numpy.log10(mean) < ceiling + 2 * LEVEL_DB


def test_the_target_lies_where_the_altitude_is_a_usual_one(sonject, tmp_path):
    """First returns grow fourfold over the pings. The target lies at a ping within 15 % of the median."""
    water = numpy.linspace(60, 240, ROWS)
    numpy.save(tmp_path / "swath.npy", Made("amplitude", water=water.astype(int)).numbers)
    start(sonject, "swath.npy", answers=["5 cm", "5 cm", "5 mm", "", "100 kHz", "30 kHz", ""])
    row = int(re.search(r"position: {row: (\d+), ", (tmp_path / "swath.yaml").read_text())[1])
    assert water[row] == pytest.approx(150, rel=0.15)


@pytest.mark.parametrize("dark", [slice(0, 100), slice(ROWS - 100, ROWS)])
def test_the_target_lies_away_from_the_images_edges(sonject, tmp_path, dark):
    """The first and the last rows are the darkest. A target there would be cut."""
    level = numpy.ones((ROWS, 1))
    level[dark] = 10 ** (-3 / 20)
    numpy.save(tmp_path / "swath.npy", (Made("amplitude").numbers * level).astype(numpy.uint16))
    start(sonject, "swath.npy")
    row = int(re.search(r"position: {row: (\d+), ", (tmp_path / "swath.yaml").read_text())[1])
    assert 100 < row < ROWS - 100


def test_the_level_of_two_sides_is_that_of_the_middle_of_a_side(sonject, tmp_path):
    """The seabed falls 12 dB with range. At the middle of a side it is 14 dB under the ceiling, as far as objects there
    can rise. Near the nadir it is 4 dB brighter."""
    chance = numpy.random.default_rng(3)
    off = numpy.abs(numpy.arange(2 * COLUMNS) - (COLUMNS - 0.5)) / COLUMNS
    seabed = numpy.where(off < 0.15, -50.0, 12 * (0.5 - off))
    speckle = numpy.abs(chance.normal(size=(ROWS, off.size)) + 1j * chance.normal(size=(ROWS, off.size))) * 0.5**0.5
    decibels = 20 * numpy.log10(speckle) + seabed + 50
    numpy.save(tmp_path / "two.npy", numpy.clip(decibels / 64 * 255, 0, 255).round().astype(numpy.uint8))
    start(sonject, "two.npy", answers=["5 cm", "5 cm", "port", "", "100 kHz", "30 kHz", ""])
    text = (tmp_path / "two_calibration.yaml").read_text()
    assert "sides: two" in text
    assert float(re.search(r"ceiling_over_seabed:\n    value: (\S+)", text)[1]) == pytest.approx(14, abs=1)


def test_both_sides_of_an_image_are_two_swaths(sonject, tmp_path):
    made = Made("amplitude", water=numpy.full(ROWS, 120)).numbers
    numpy.save(tmp_path / "both.npy", numpy.hstack([made[:, ::-1], made]))
    answer = start(sonject, "both.npy", "--campaign", answers=["5 cm", "5 cm", "starboard", "", "100 kHz", "30 kHz", ""])
    assert re.search(r"slant range 0\.\d+\.\.\.39\.\d+ m, starboard", answer.stdout), answer.stdout  # 800 columns of 5 cm
    text = (tmp_path / "both_campaign.yaml").read_text()
    assert re.findall(r"side: (\w+)", text) == ["starboard", "port"]
    assert "# without it, the middle of the side" in (tmp_path / "both.yaml").read_text()
    columns, spacing = re.search(r"columns: (\d+), spread.* a column (\S+) m", text).groups()
    assert spacing == "0.05"
    shadow = 0.75 * COLUMNS * 0.5 / (120 * 0.05 - 0.5)  # in columns, as in the chips of a recording
    assert int(columns) % 32 == 0 and -2 <= int(columns) - 3 * shadow < 34
    assert (tmp_path / "both_quicklook.png").exists()
    sonject.done("campaign", "both_campaign.yaml", "-o", "set", "--set", "images=4")


def test_places_along_the_track_are_as_the_pictures_axes_have_them(sonject, tmp_path):
    """Places use the mean spacing of all pings, 10 cm, though the first half is slow and the second fast. Middles of chips
    are right, and rows 5 from them, 10 % of 48, are off by 5 cm each. A line that ends where it began has no such axis."""
    along = numpy.cumsum(numpy.where(numpy.arange(ROWS) < ROWS / 2, 0.05, 0.15))
    write_line(tmp_path, row_spacing=along)
    start(sonject, *OF_PORT, answers=PORT_ANSWERS)
    sonject.done("campaign", "line_campaign.yaml", "-o", "set", "--set", "images=40", "--set", "chip.rows=48", "--set",
                 "swaths[0].avoid=[{along_track: [0 m, 30 m], slant_range: [0 m, 30 m]}]")
    records = [json.loads(path.read_text()) for path in (tmp_path / "set").glob("*/records/*.json")]
    rows = {split: [record["swath"]["row"] for record in records if record["split"] == split] for split in ("train", "val")}
    assert 301 <= min(rows["train"]) < 400 and min(rows["val"]) < 100, rows  # port is for training
    truths = [json.loads((tmp_path / "set" / record["split"] / record["files"][1]["name"]).read_text()) for record in records]
    rows, found = numpy.transpose([(record["swath"]["row"] + it["row"], it["along_track_m"])
                                   for record, truth in zip(records, truths) for it in truth["objects"]])
    assert len(rows) > 20 and max(rows) - min(rows) > 300
    assert found == pytest.approx((along[-1] - along[0]) / (ROWS - 1) * rows, abs=0.05 * 5)
    back = numpy.interp(numpy.arange(ROWS), [0, ROWS / 2, ROWS - 1], [0, 20, 0])
    write_line(tmp_path, row_spacing=back)
    sonject.done("campaign", "line_campaign.yaml", "-o", "back", "--set", "images=4", "--set", "chip.rows=48")


def test_one_image_has_no_splits_and_a_target_may_be_a_file(sonject, image):
    (image.parent / "scenes").mkdir()
    (image.parent / "ball.yaml").write_text("sonject_target: 1\nshape: sphere\ndiameter: 0.4 m\n")
    start(sonject, "swath.npy", "--target", "ball.yaml", "--campaign", "-o", "scenes/mine.yaml")
    text = (image.parent / "scenes" / "mine_campaign.yaml").read_text()
    assert "\nsplits" not in text and text.count("- path:") == 1 and 'class: "ball"' in text
    sonject.done("campaign", "scenes/mine_campaign.yaml", "-o", "set", "--set", "images=4")


@pytest.mark.parametrize("name, text, why", [
    ("rock.stl", None, "there is no file rock.stl"), ("rock.obj", "v 0 0\n", "rock.obj"),
    ("rock.yaml", "sonject_target: 1\nshape: sphere\n", "rock.yaml")])
def test_a_target_that_is_none_is_told_before_any_question(sonject, image, name, text, why):
    if text:
        (image.parent / name).write_text(text)
    answer = init(sonject, "swath.npy", "--target", name, answers=ANSWERS)
    assert answer.returncode == 3 and why in answer.stderr and "calibrating" not in answer.stderr
    assert {path.name for path in image.parent.iterdir()} <= {"swath.npy", name}
