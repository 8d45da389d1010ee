"""Tests of XTF and JSF files and NumPy arrays as input: they are read, injected into and written back."""

import json
import os
import re
import subprocess

import numpy
import pytest

import images
import recordings
from conftest import assert_refused
from measured_images import measured, read_png
from recordings import EXPLICIT, assert_patch_alone_changed, samples_of, write_scene

ROWS, COLUMNS = 60, 200
LINE = "sidescan/scotsman-iver2.xtf"


MAKERS = {"xtf": recordings.xtf_bytes, "jsf": recordings.jsf_bytes}


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("number, side", enumerate(("port", "starboard")))
def test_a_channel_is_as_its_pixels_in_a_tiff(sonject, tmp_path, sides, kind, number, side):
    before = MAKERS[kind](*sides)
    assert numpy.array_equal(samples_of(before, number)[0], sides[number])
    (tmp_path / f"line.{kind}").write_bytes(before)
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(sides[number]))
    explicit = EXPLICIT.replace("}", f", side: {side}}}")
    sonject.done("run", write_scene(tmp_path, f"line.{kind}", side), "-o", "of_line")
    sonject.done("run", write_scene(tmp_path, "line.tif", geometry=explicit, altitude="6 m"), "-o", "tif")
    after = (tmp_path / "of_line" / f"image.{kind}").read_bytes()
    assert numpy.array_equal(samples_of(after, number)[0], images.read_tiff(tmp_path / "tif" / "image.tif"))
    assert_patch_alone_changed(before, after, number)


@pytest.mark.parametrize("east, north", [(0.0, 1 / 111412.28), (1 / 55799.98, 0.0)])
def test_degrees_are_metres_on_the_ground(sonject, tmp_path, sides, east, north):
    """The steps are degrees of a metre at 60 degrees north, by the known series for the ellipsoid of WGS 84."""
    header = recordings.file_header([recordings.STARBOARD], units=3)
    data = header + b"".join(
        recordings.ping([(0, line.astype("<u2"))], position=(7.0 + row * east, 60.0 + row * north))
        for row, line in enumerate(sides[1]))
    (tmp_path / "line.xtf").write_bytes(data)
    answer = sonject.done("check", write_scene(tmp_path, "line.xtf"))
    assert "40.00 m along-track, slant range 9.07...26.92 m, starboard" in answer.stdout


def test_empty_pings_change_no_geometry(sonject, tmp_path, sides):
    """Some or all of the patch's rows 10 to 49 are empty. The pings around them then tell the geometry."""
    scene = write_scene(tmp_path, "line.xtf", channel="port")
    answers = set()
    for rows in ((), {10}, {49}, set(range(10, 49)), set(range(5, 55))):
        (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, empty=rows))
        answers.add(sonject.done("check", scene).stdout)
    assert len(answers) == 1


@pytest.mark.parametrize("spacing, empty, words", [
    (0.1, range(ROWS), "line.xtf: fewer than two of its pings have a position"),
    (0.0, (), "line.xtf: the patch's pings all have the same position"),
])
def test_a_geometry_that_is_not_told_is_refused_at_its_key(sonject, tmp_path, sides, spacing,
                                                           empty, words):
    (tmp_path / "line.xtf").write_bytes(
        recordings.xtf_bytes(*sides, row_spacing=spacing, empty=empty))
    scene = write_scene(tmp_path, "line.xtf", channel="port")
    column = scene.read_text().splitlines()[1].index("from_file") + 1
    assert_refused(sonject("check", scene), 3, f":2:{column}: input.geometry: ", words)


# Each size of number has both orders of bytes.
@pytest.mark.parametrize("kind, order", [("u1", "<"), ("u2", "<"), ("i2", ">"), ("u4", ">"), ("i4", "<"),
                                         ("f4", ">"), ("f8", "<"), ("f8", ">"), ("c8", "<"),
                                         ("c16", ">")])
def test_arrays_come_back_as_they_were(sonject, tmp_path, sides, kind, order):
    """Arrays keep type and order. Untouched samples keep every bit, although floats hold only 24."""
    pixels = sides[0] / 19999.0
    if kind[0] in "ui":
        pixels = pixels * numpy.iinfo(kind).max
    array = pixels.astype(numpy.dtype(kind).newbyteorder(order))
    if order == ">":
        array = numpy.asfortranarray(array)
    numpy.save(tmp_path / "line.npy", array)
    scene = write_scene(tmp_path, "line.npy", geometry=EXPLICIT, altitude="6 m")
    if kind[0] == "c":
        scene.write_text(scene.read_text().replace("path: line.npy,",
                                                   "path: line.npy, complex: true,"))
    sonject.done("run", scene, "-o", "out")
    after = numpy.load(tmp_path / "out" / "image.npy")
    assert after.dtype == array.dtype and after.shape == array.shape
    assert after.flags.f_contiguous == array.flags.f_contiguous
    changed = numpy.argwhere(after != array)
    assert 50 < len(changed) < 40 * 120 / 2
    assert (changed.min(0) >= (10, 60)).all() and (changed.max(0) < (50, 180)).all()


def test_full_scale_is_where_the_recorder_clips(sonject, tmp_path, sides):
    sides[0][20:30, 100:110] = 4095
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides))
    scene = write_scene(tmp_path, "line.xtf", channel="port")
    sonject.done("run", scene, "-o", "out", "--set",
                 "input.transfer={kind: amplitude, full_scale: 4095}")
    facts = json.loads((tmp_path / "out" / "run.json").read_text())
    inside = sides[0][10:50, 60:180]
    assert facts["input_clipped_pixels"] == (inside >= 4095).sum()
    after, _ = samples_of((tmp_path / "out" / "image.xtf").read_bytes(), 0)
    assert after[10:50, 60:180].max() == max(4095, inside.max())


def as_array(samples):
    return (samples[..., 0] + 1j * samples[..., 1]).astype("c8") if samples.ndim == 3 else samples


@pytest.mark.parametrize("kind, is_analytic", [("xtf", False), ("jsf", False), ("jsf", True)])
def test_pings_are_weighed(sonject, tmp_path, sides, kind, is_analytic):
    """A ping of weight N has samples in units of 2^-N. The finest steps are 1. 16 bits clip larger values. Equal weights
    change nothing."""
    random = numpy.random.default_rng(5)
    weights = random.integers(-2, 3, ROWS)
    weights[:2] = -2, 2
    port = random.normal(0.0, 3000.0, (ROWS, COLUMNS, 2)).astype(numpy.int16) if is_analytic else sides[0]
    scale = (2.0 ** (2 - weights)).reshape(ROWS, *[1] * (port.ndim - 1))
    for name, told in (("equal", numpy.full(ROWS, 3)), ("line", weights)):
        (tmp_path / f"{name}.{kind}").write_bytes(MAKERS[kind](port, port, weights=told))
        sonject.done("convert", f"{name}.{kind}", "a.npy", "--channel", "port")
        shown = numpy.load(tmp_path / "a.npy")
        assert shown.dtype == ("c8" if is_analytic else "f4" if name == "line" else "u2")
        assert numpy.array_equal(shown, as_array(port * scale if name == "line" else port))
    other = (port * scale).astype("f4")
    other[4, 5] = 1e9
    other[5, 6] = 100.4 * scale[5]
    numpy.save(tmp_path / "b.npy", as_array(other))
    into = ("--into", f"line.{kind}", "--channel", "port")
    noted = sonject.done("convert", "b.npy", f"back.{kind}", *into)
    assert f"note: back.{kind} cannot hold {1 + is_analytic} of the changed numbers" in noted.stderr
    expected = numpy.array(port)
    expected[4, 5], expected[5, 6] = 32767 if is_analytic else 65535, 100
    back = (tmp_path / f"back.{kind}").read_bytes()
    assert numpy.array_equal(samples_of(back, 0)[0], expected) and numpy.array_equal(samples_of(back, 1)[0], port)
    other[7, 8] = numpy.nan
    numpy.save(tmp_path / "b.npy", as_array(other))
    assert_refused(sonject("convert", "b.npy", f"nan.{kind}", *into), 3,
                   "the sample at row 7, column 8 is not a number, which the file cannot hold")


REFUSALS = {
    "no channel": (lambda data: data, "", "choose one by input.channel or --channel, 1 (port), 2 (starboard)"),
    "wrong channel": (lambda data: data, "0", "choose one by input.channel or --channel, 1 (port), 2 (starboard)"),
    "cut short": (lambda data: data[:-100], "port", "cut short"),
    "no packet": (lambda data: data[:1024] + b"\0" * 300, "port", "no packet"),
    "only a header": (lambda data: data[:1024], "port", "has no pings"),
    "half a header": (lambda data: data[:200], "port", "header is cut short"),
    "more samples": (lambda data: data[:1024 + 256 + 42] + b"\xff\xff\xff\xff" +
                     data[1024 + 256 + 46:], "port", "more samples than the ping holds"),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_damaged_recordings_are_refused(sonject, tmp_path, sides, case):
    damage, channel, words = REFUSALS[case]
    (tmp_path / "line.xtf").write_bytes(damage(recordings.xtf_bytes(*sides)))
    answer = sonject("run", write_scene(tmp_path, "line.xtf", channel=channel), "-o", "out")
    assert_refused(answer, 3, words)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("told, words", [
    ({"slant_range": 50.0}, "ping 60 has 200 samples from 0 to 50 m, the first ping 200 from 0 to 30 m"),
    ({"delay": 0.01}, "ping 60 has 200 samples from 7.5 to 30 m, the first ping 200 from 0 to 30 m"),
    ({"slant_range": 30.16}, "ping 60 has 200 samples from 0 to 30.16 m"),
    ({"slant_range": 30.14}, None),
    ({"delay": 0.14 / 750}, None),
])
def test_range_cells_of_a_file_lie_within_one_cell(sonject, tmp_path, sides, told, words):
    data = recordings.xtf_bytes(*sides)
    data += recordings.ping([(1, sides[0][0].astype("<u2"))], **told)
    (tmp_path / "line.xtf").write_bytes(data)
    answer = sonject("check", write_scene(tmp_path, "line.xtf", channel="port"))
    if words:
        assert_refused(answer, 3, words)
    else:
        assert answer.returncode == 0, answer.stderr


def test_signed_samples_below_zero_are_refused(sonject, tmp_path, sides):
    sides[1][30, 100] = 40000
    data = recordings.file_header([recordings.STARBOARD], unipolar=0) + b"".join(
        recordings.ping([(0, line.astype("<u2"))], position=(0.1 * row, 1.0))
        for row, line in enumerate(sides[1]))
    (tmp_path / "line.xtf").write_bytes(data)
    answer = sonject("run", write_scene(tmp_path, "line.xtf"), "-o", "out")
    assert_refused(answer, 3, "the sample at row 30, column 100 is negative")


@pytest.mark.parametrize("array, words", [
    (numpy.zeros((4, 5, 2), numpy.float32), "not two-dimensional"),
    (numpy.zeros((40, 50), numpy.int64), "a type that sonject does not read"),
    (-numpy.ones((60, 200), numpy.int32), "the sample at row 10, column 60 is negative"),
    (numpy.full((60, 200), 1e300), "the sample at row 10, column 60 is beyond what float32 holds"),
])
def test_other_arrays_are_refused(sonject, tmp_path, array, words):
    numpy.save(tmp_path / "line.npy", array)
    scene = write_scene(tmp_path, "line.npy", geometry=EXPLICIT, altitude="6 m")
    assert_refused(sonject("run", scene, "-o", "out"), 3, words)


def test_a_measured_line_works_from_its_first_pixel(sonject, tmp_path):
    """The line's first ping is empty, and its first columns are nearer than the pulse's reach."""
    (tmp_path / "line.xtf").write_bytes(measured(LINE).read_bytes())
    scene = write_scene(tmp_path, "line.xtf", channel="starboard")
    options = ["--set", "patch={row: 0, column: 0, rows: 100, columns: 900}", "--set",
               "sonar.bandwidth=25 kHz"]
    sonject.done("run", scene, "-o", "out", *options)
    # 99 pings with positions against 99 of 100 give the same length to a step of the recorder's positions
    lengths = [float(re.search("([0-9.]+) m along-track", sonject("check", scene, *options, *more)
                               .stdout)[1]) for more in ([], ["--set", "patch.row=1"])]
    assert lengths[0] == pytest.approx(lengths[1], abs=0.3)


def test_a_measured_line_is_read_by_others(sonject, tmp_path):
    """pyxtf reads the Iver2's line after an injection at 10 to 28 m to port."""
    line = measured(LINE)
    reader = os.environ.get("SONJECT_READERS")
    if not reader:
        pytest.skip("SONJECT_READERS does not name a Python that has pyxtf")
    (tmp_path / "line.xtf").write_bytes(line.read_bytes())
    scene = write_scene(tmp_path, "line.xtf", channel="port")
    sonject.done("run", scene, "-o", "out", "--set",
                 "patch={row: 10, column: 340, rows: 120, columns: 600}", "--set",
                 "sonar.bandwidth=25 kHz")
    script = ("import sys, numpy, pyxtf\n"
              "for path in sys.argv[1:]:\n"
              "    head, packets = pyxtf.xtf_read(path)\n"
              "    pings = packets[pyxtf.XTFHeaderType.sonar]\n"
              "    for channel in range(2):\n"
              "        numpy.save(f'{path}.{channel}.npy',\n"
              "                   numpy.array([ping.data[channel] for ping in pings]))\n")
    subprocess.run([reader, "-c", script, tmp_path / "line.xtf", tmp_path / "out" / "image.xtf"],
                   check=True, env={**os.environ, "PYTHONPATH": ""})
    port, starboard = (
        (numpy.load(f"{tmp_path}/line.xtf.{channel}.npy").astype(float),
         numpy.load(f"{tmp_path}/out/image.xtf.{channel}.npy").astype(float))
        for channel in range(2))
    assert port[0].shape == (461, 1024)
    assert numpy.array_equal(*starboard)
    changed = numpy.argwhere(port[0] != port[1])
    assert len(changed) > 100
    assert (changed.min(0) >= (10, 1024 - 940)).all()
    assert (changed.max(0) < (130, 1024 - 340)).all()


def test_of_a_whole_line_the_altitude_is_that_at_the_objects(sonject, tmp_path, sides):
    altitudes = numpy.linspace(5.0, 9.0, ROWS)
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=altitudes))
    text = write_scene(tmp_path, "line.xtf", channel="port").read_text()
    kept = "\n".join(line for line in text.splitlines() if not line.startswith(("patch", "objects")))
    ball = "{shape: sphere, diameter: 0.4 m, position: {row: %d, column: 120}}"
    (tmp_path / "one.yaml").write_text(f"{kept}\nobjects: [{ball % 15}]\n")
    (tmp_path / "two.yaml").write_text(f"{kept}\nobjects: [{ball % 15}, {ball % 45}]\n")
    (tmp_path / "none.yaml").write_text(f"{kept}\n")
    assert "altitude 7 m, wavelength" in sonject.done("check", "none.yaml").stdout
    told = sonject.done("check", "one.yaml").stdout
    assert "note" not in told and "m at the objects' pings, wavelength" in told
    assert "altitudes of the pings: 7 m in the median, 5.2...8.8 m (5...95 %)" in told
    (tmp_path / "pings.csv").write_text(f"row,altitude_m\n0,6\n{ROWS - 1},6\n")
    assert "note: the altitude" not in sonject.done("check", "two.yaml", "--set", "input.pings=pings.csv").stdout
    assert "note: the altitude" not in sonject.done("run", "one.yaml", "-o", "one").stderr
    numbers = json.loads((tmp_path / "one" / "truth.json").read_text())["numbers"]
    assert numbers["altitude_m"] == {"value": pytest.approx(altitudes[15], abs=1e-5), "from": "file"}
    for position, altitude in ("", altitudes[29:31].mean()), ("position: {along_track: 2 m, slant_range: 18 m}", altitudes[20]):
        (tmp_path / "other.yaml").write_text(f"{kept}\nobjects: [{{shape: sphere, diameter: 0.4 m, {position}}}]\n")
        assert f"altitude {altitude:.3g} m" in sonject.done("check", "other.yaml").stdout
    told = rf"the altitude varies from {altitudes[15]:.2f} to {altitudes[45]:.2f} m"
    assert told in sonject.done("check", "two.yaml").stdout
    assert told in sonject.done("run", "two.yaml", "-o", "two").stderr
    # the mean altitude of a patch counts if the user has chosen the patch
    chosen = text.replace("objects: [{", "objects: [{position: {row: 45, column: 120}, ")
    (tmp_path / "chosen.yaml").write_text(chosen)
    sonject.done("run", "chosen.yaml", "-o", "chosen")
    numbers = json.loads((tmp_path / "chosen" / "truth.json").read_text())["numbers"]
    assert numbers["altitude_m"]["value"] == pytest.approx(altitudes[10:50].mean(), abs=1e-5)
    assert "row 45.0" in sonject.done("check", "chosen.yaml").stdout


def test_contacts_of_a_recording_are_measured_in_metres(sonject, tmp_path, sides):
    sides[0][20:30, 100:104] *= 20
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides))
    box = ("--box", "15,80,20,50")
    of_file, given = (json.loads(sonject.done("measure", "line.xtf", "--channel", "port", *box, *more).stdout)
                      for more in ((), ("--row-spacing", "0.1", "--column-spacing", "0.15")))
    (one,), (other,) = of_file["contacts"], given["contacts"]
    assert one["highlight_along_m"] == pytest.approx(other["highlight_along_m"], rel=1e-3) and other["highlight_along_m"] > 0


def test_an_altitude_that_changes_is_not_converted(sonject, tmp_path, sides):
    for name, altitudes in ("level", numpy.full(ROWS, 6.0)), ("sloping", numpy.linspace(5.0, 9.0, ROWS)):
        (tmp_path / f"{name}.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=altitudes))
        answer = sonject.done("convert", f"{name}.xtf", f"{name}.tif", "--channel", "port")
        assert ("it is left out" in answer.stderr) == (name == "sloping")
        scene = write_scene(tmp_path, f"{name}.tif")
        if name == "level":
            sonject.done("check", scene)
        else:
            assert_refused(sonject("check", scene), 3, "does not say the sonar's altitude")


def test_a_campaign_keeps_out_of_the_water_column_whatever_the_altitude(sonject, tmp_path, sides):
    altitudes = numpy.linspace(5.0, 9.0, ROWS)
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=altitudes))
    scene = write_scene(tmp_path, "line.xtf", channel="port").read_text()
    kept = [line for line in scene.splitlines() if not line.startswith(("patch", "objects"))]
    (tmp_path / "scene.yaml").write_text("\n".join(kept) + "\n")
    (tmp_path / "campaign.yaml").write_text("""\
sonject_campaign: 1
scene: scene.yaml
images: 12
chip: {rows: 16, columns: 60}
swaths: [{path: line.xtf}]
targets: [{class: ball, object: {shape: sphere, diameter: 0.4 m}}]
""")
    sonject.done("campaign", "campaign.yaml", "-o", "data")
    records = list((tmp_path / "data" / "all" / "records").iterdir())
    assert len(records) == 12
    for path in records:
        place = json.loads(path.read_text())["swath"]
        assert 0.15 * (place["column"] + 0.5) > altitudes[place["row"] + 15]


@pytest.mark.parametrize("kind", MAKERS)
def test_pings_without_samples_make_no_row_and_are_named(sonject, tmp_path, sides, kind):
    """The image has only the other pings' rows. Truth and patch count these rows."""
    gone = {3, 20, 21, 59}
    options = {"silent": gone} if kind == "xtf" else {"empty": gone}
    (tmp_path / f"line.{kind}").write_bytes(MAKERS[kind](*sides, **options))
    sonject.done("convert", f"line.{kind}", "a.npy", "--channel", "port")
    kept = [row for row in range(ROWS) if row not in gone]
    assert numpy.array_equal(numpy.load(tmp_path / "a.npy"), sides[0][kept])
    scene = write_scene(tmp_path, f"line.{kind}", channel="port")
    assert "pings without samples give no row: 3, 20, 21, 59\n" in sonject.done("check", scene).stdout
    answer = sonject.done("run", scene, "-o", "out")
    assert "note: pings without samples give no row: 3, 20, 21, 59\n" in answer.stderr
    truth = json.loads((tmp_path / "out" / "truth.json").read_text())
    assert truth["patch"]["skipped_pings"] == sorted(gone) and truth["patch"]["empty_rows"] == []
    before, after = ((tmp_path / name).read_bytes() for name in (f"line.{kind}", f"out/image.{kind}"))
    assert len(before) == len(after) and before != after


def test_empty_rows_stay_as_they_are_and_are_named(sonject, tmp_path, sides):
    """Empty rows hold nothing but 0, in a recording or any image. A row that is dark only in the patch
    is not empty."""
    pixels = sides[0]
    pixels[[10, 11, 28, 30, 31, 55]] = 0
    pixels[29, 60:180] = 0
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(pixels))
    scene = write_scene(tmp_path, "line.tif", geometry=EXPLICIT, altitude="6 m")
    answer = sonject.done("run", scene, "-o", "out")
    assert "note: empty rows stay as they are: 10, 11, 28, 30, 31\n" in answer.stderr
    facts, truth = (json.loads((tmp_path / "out" / name).read_text()) for name in ("run.json", "truth.json"))
    assert truth["patch"]["empty_rows"] == [10, 11, 28, 30, 31]
    after = images.read_tiff(tmp_path / "out" / "image.tif")
    changed = (after != pixels).sum(1)
    assert changed[29] > 5 and changed[27] > 5 and not changed[[28, 30, 31]].any()
    assert facts["changed_pixels"] == pytest.approx(changed.sum(), rel=0.1)
    masks = [read_png(tmp_path / "out" / f"{name}.png")
             for name in ("highlight", "shadow", "labels", "influence")]
    assert all(mask[29].any() and not mask[[28, 30, 31]].any() for mask in masks[-2:])
    assert not any(mask[[28, 30, 31]].any() for mask in masks)
    assert facts["changed_pixels"] == (masks[-1] > 0).sum()
    found, labelled = truth["objects"][0], json.loads((tmp_path / "out" / "coco.json").read_text())["annotations"][0]
    assert not labelled["occluded"]
    for key, mask in zip(("highlight", "shadow"), masks):
        rows, columns = numpy.nonzero(mask)
        box = found[key]
        assert [rows.min(), numpy.ptp(rows) + 1, columns.min(), numpy.ptp(columns) + 1] == [
            box[side] for side in ("row", "rows", "column", "columns")]
        assert found[f"{key}_pixels"] == len(rows)
    # levels and floors are measured outside the empty rows
    shown = pixels.copy()
    shown[10] = shown[11] = pixels[12]
    shown[28], shown[30], shown[31] = pixels[27], pixels[29], pixels[29]
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(shown))
    sonject.done("run", scene, "-o", "whole")
    other = json.loads((tmp_path / "whole" / "truth.json").read_text())
    assert other["blending"] == truth["blending"]
    pixels[10:50] = 0
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(pixels))
    assert_refused(sonject("run", scene, "-o", "none"), 3, "line.tif.yaml:3:8: patch: ",
                   "all rows of the patch are empty (0): choose another")
