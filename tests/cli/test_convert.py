"""Tests of sonject convert: sonar formats to rasters and back, without guesses or cut values."""

import os
import struct
import zlib

import numpy
import pytest

import images
import recordings
from conftest import assert_refused, write_text

ROWS, COLUMNS = 40, 120
ALTITUDE, SPACING = 6.0, 30.0 / COLUMNS


@pytest.fixture
def line(tmp_path, sides):
    """Writes line.xtf: port and starboard to 30 m, 10 cm between pings, at an altitude of 6 m."""
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides))
    return tmp_path / "line.xtf"


def interlaced_png(pixels):
    """Returns a 16 bit PNG interlaced by Adam7, with a description as other programs write it."""
    rows = len(pixels)
    passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
    lines = [pixels[row, x::across].astype(">u2").tobytes()
             for x, y, across, down in passes for row in range(y, rows, down) if x < pixels.shape[1]]

    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    head = struct.pack(">IIBBBBB", pixels.shape[1], rows, 16, 0, 0, 0, 1)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"tEXt", b"Description\0sonject:altitude_m=6")
            + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + line for line in lines))) + chunk(b"IEND", b""))


def test_interlaced_pngs_are_read(sonject, tmp_path):
    pixels = numpy.random.default_rng(3).integers(0, 65536, (13, 21), "u2")
    (tmp_path / "a.png").write_bytes(interlaced_png(pixels))
    sonject.done("convert", "a.png", "b.tif")
    assert numpy.array_equal(images.read_tiff(tmp_path / "b.tif"), pixels)
    assert b"sonject:altitude_m=6" in (tmp_path / "b.tif").read_bytes()
    (tmp_path / "a.png").write_bytes((tmp_path / "a.png").read_bytes()[:-60])
    assert_refused(sonject("convert", "a.png", "c.tif"), 3, "cut short")
    assert not (tmp_path / "c.tif").exists()


def test_a_recording_goes_through_rasters_and_back(sonject, tmp_path, line, sides):
    sonject.done("convert", "line.xtf", "a.tif", "--channel", "port")
    assert numpy.array_equal(images.read_tiff(tmp_path / "a.tif"), sides[0])
    told = (tmp_path / "a.tif").read_bytes()
    for note in (b"sonject:row_spacing_m=0.1\n", b"sonject:column_spacing_m=0.25\n",
                 b"sonject:first_slant_range_m=0.125\n", b"sonject:altitude_m=6\n",
                 b"sonject:side=port\n", b"sonject:range_axis=slant"):
        assert note in told
    assert b"frequency" not in told  # the recording does not tell it
    sonject.done("convert", "a.tif", "b.png")
    assert b"sonject:altitude_m=6\n" in (tmp_path / "b.png").read_bytes()
    answer = sonject.done("convert", "b.png", "c.npy")
    assert "c.npy keeps no geometry" in answer.stderr
    array = numpy.load(tmp_path / "c.npy")
    assert array.dtype == "<u2" and numpy.array_equal(array, sides[0])
    numpy.save(tmp_path / "d.npy", array[::-1])
    sonject.done("convert", "d.npy", "new.xtf", "--into", "line.xtf", "--channel", "port")
    changed = bytearray(line.read_bytes())
    assert changed != (tmp_path / "new.xtf").read_bytes()
    sonject.done("convert", "c.npy", "same.xtf", "--into", "new.xtf", "--channel", "port")
    assert (tmp_path / "same.xtf").read_bytes() == changed


TAKEN = """\
sonject: 1
input: {{path: {}, {} geometry: from_file}}
sonar: {{frequency: 600 kHz, bandwidth: 10 kHz, altitude: from_file, resolution: 0.2 m}}
patch: {{row: 2, column: 40, rows: 30, columns: 70}}
objects: [{{name: ball, shape: sphere, diameter: 1 m}}]
"""


def write_taken(folder, name, channel=""):
    """Writes a scene that takes geometry and altitude from the file."""
    (folder / "taken.yaml").write_text(TAKEN.format(name, channel))
    return "taken.yaml"


def test_scenes_take_what_the_conversion_kept(sonject, tmp_path, line):
    extensions = [".tif", ".png"] + [".h5"] * (os.environ.get("SONJECT_HAS_HDF5") == "1")
    expected = sonject.done("check", write_taken(tmp_path, "line.xtf", "channel: starboard,")).stdout
    assert "3.00 m along-track" in expected and "starboard" in expected
    for extension in extensions:
        sonject.done("convert", "line.xtf", "a" + extension, "--channel", "starboard")
        told = sonject.done("check", write_taken(tmp_path, "a" + extension)).stdout
        assert told == expected


def test_scenes_take_nothing_that_a_file_does_not_say(sonject, tmp_path, line):
    numpy.save(tmp_path / "a.npy", numpy.ones((ROWS, COLUMNS), "u1"))
    assert_refused(sonject("check", write_taken(tmp_path, "a.npy")), 3, "does not say where its pixels lie",
                   "row_spacing, column_spacing and first_slant_range")
    notes = {"row_spacing_m": 0.1, "column_spacing_m": 0.25, "first_along_track_m": 0,
             "first_slant_range_m": 0.125, "altitude_m": 6, "side": "port", "range_axis": "slant"}

    for words, changes in (
            (None, {}), ("does not say where its pixels lie", {"side": None}),
            ("does not say where its pixels lie", {"side": "left"}),
            ("does not say where its pixels lie", {"range_axis": None}),
            ("does not say where its pixels lie", {"row_spacing_m": "1e999"}),
            ("does not say where its pixels lie", {"column_spacing_m": -0.25}),
            ("does not say the sonar's altitude", {"altitude_m": None}),
            ("its altitude must be", {"altitude_m": "1e30"}),
            ("--range-axis slant", {"range_axis": "ground"})):
        lines = {name: value for name, value in {**notes, **changes}.items() if value is not None}
        text = "\n".join(f"sonject:{name}={value}" for name, value in lines.items()).encode()
        (tmp_path / "a.png").write_bytes(images.png_bytes(numpy.zeros((ROWS, COLUMNS)), text))
        answer = sonject("check", write_taken(tmp_path, "a.png"))
        assert answer.returncode == 0 if words is None else not assert_refused(answer, 3, words)


def test_numbers_beyond_single_precision_are_refused(sonject, tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    h5py = pytest.importorskip("h5py")
    image = numpy.array([[1.0, numpy.inf, numpy.nan], [3.4e38, 1e-300, 1e300]])
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["image"] = image
    scipy_io.savemat(tmp_path / "a.mat", {"image": image})
    for name in ["a.mat"] + ["a.h5"] * (os.environ.get("SONJECT_HAS_HDF5") == "1"):
        assert_refused(sonject("convert", name, "b.npy"), 3, "row 1, column 2", "float32")


SONAR = "frequency: 600 kHz, bandwidth: 10 kHz, resolution: 0.2 m"
BALL = "{name: ball, shape: sphere, diameter: 1 m}"


def check_injection(sonject, folder, name, before, extension):
    """Asserts that a run changes the input's samples within the patch alone. Returns the command's answer."""
    write_text(folder, f"path: {name}", "row_spacing: 10 cm, column_spacing: 10 cm, side: port, first_slant_range: 15 m", BALL, "6 m",
               SONAR, "patch: {row: 4, column: 10, rows: 32, columns: 60}")
    answer = sonject.done("run", "scene.yaml", "-o", "out")
    image = folder / "out" / ("image" + extension)
    sonject.done("convert", image, "after.npy")
    after = numpy.load(folder / "after.npy")
    assert after.dtype == before.dtype
    inside = numpy.zeros(before.shape, bool)
    inside[4:36, 10:70] = True
    assert numpy.array_equal(after[~inside], before[~inside])
    assert (after[inside] != before[inside]).any()
    return answer


@pytest.mark.parametrize("description", [
    b"tEXtDescription\0from the pier", b"tEXtDescription\0" + "Grüße".encode("latin-1"),
    b"iTXtDescription\0\0\0\0\0" + "Grüße".encode()])
def test_png_goes_out_as_a_new_png(sonject, tmp_path, sides, description):
    before = (sides[0] // 64).astype("u1")
    (tmp_path / "line.png").write_bytes(images.png_bytes(before, head=description))
    answer = check_injection(sonject, tmp_path, "line.png", before, ".png")
    assert description in (tmp_path / "out/image.png").read_bytes()
    assert "note: image.png is a new file" in answer.stderr
    assert sonject.done("run", "scene.yaml", "-o", "again", "--quiet").stderr == ""
    assert_refused(sonject("convert", "line.png", "b.png", "--into", "line.png"), 3,
                   "not changed in place: write a new .tif")


def test_hdf5_keeps_samples_and_geometry(sonject, tmp_path, line, sides):
    h5py = pytest.importorskip("h5py")
    sonject.done("convert", "line.xtf", "a.h5", "--channel", "starboard")
    with h5py.File(tmp_path / "a.h5") as file:
        assert numpy.array_equal(file["image"][()], sides[1])
        assert file["image"].attrs["sonject:side"] in ("starboard", b"starboard")
    sonject.done("convert", "a.h5", "b.tif")
    assert numpy.array_equal(images.read_tiff(tmp_path / "b.tif"), sides[1])
    assert b"sonject:side=starboard\n" in (tmp_path / "b.tif").read_bytes()


def test_types_of_samples_stay(sonject, tmp_path, swath):
    image = (swath * numpy.exp(1j * swath * 50)).astype(numpy.complex64)
    numpy.save(tmp_path / "a.npy", image)
    sonject.done("convert", "a.npy", "b.tif")
    sonject.done("convert", "b.tif", "c.npy")
    assert numpy.array_equal(numpy.load(tmp_path / "c.npy"), image)
    assert_refused(sonject("convert", "a.npy", "d.png"), 3, "does not hold complex samples")
    numpy.save(tmp_path / "a.npy", swath)
    assert_refused(sonject("convert", "a.npy", "b.png"), 3, "does not hold floating-point samples")
    assert not (tmp_path / "b.png").exists()


@pytest.mark.parametrize("kind", ["u4", "i4"])
def test_integers_that_floats_would_round_are_refused(sonject, tmp_path, kind):
    pixels = numpy.full((4, 5), 2**24, kind)
    pixels[1, 2] = 2**24 + 2
    numpy.save(tmp_path / "a.npy", pixels)
    sonject.done("convert", "a.npy", "a.tif")
    assert numpy.array_equal(images.read_tiff(tmp_path / "a.tif"), pixels)
    pixels[2, 3:] = 2**24 + 1
    numpy.save(tmp_path / "a.npy", pixels)
    assert_refused(sonject("convert", "a.npy", "b.tif"), 3,
                   "the sample at row 2, column 3 is 16777217, which float32 would round")
    sonject.done("convert", "a.npy", "grey.png", "--db=-60:0")


@pytest.mark.parametrize("output", ["a.tif", "a.png", "a.h5"])
def test_the_full_scale_stays(sonject, tmp_path, sides, output):
    """A curve gives the same amplitudes for int16 samples and for the uint16 ones that they become."""
    numpy.save(tmp_path / "a.npy", (sides[0] // 3).astype("i2"))
    sonject.done("convert", "a.npy", output)
    curve = ("--transfer", "schlick:20")
    expected = sonject.done("measure", "a.npy", *curve).stdout
    assert sonject.done("measure", output, *curve).stdout == expected
    noted = sonject.done("convert", output, "b.npy")
    assert "b.npy has no place for the full scale" in noted.stderr and "full_scale to 32767" in noted.stderr
    assert sonject.done("measure", "b.npy", *curve).stdout != expected
    sonject.done("convert", output, "grey.tif", "--db=-60:0")
    assert b"full_scale" not in (tmp_path / "grey.tif").read_bytes()


def test_runs_note_the_curve_of_grey_levels_in_db(sonject, scene, tmp_path):
    sonject.done("convert", "swath.tif", "grey.png", "--db=-61:-10")
    note = "grey.png says that its numbers are grey levels from -61 to -10 dB: set input.transfer to "
    curve = "{kind: decibel, parameter: 0.2, offset: -61 dB}"
    for verb in (["check"], ["run", "-o", "out", "--overwrite"]):
        told = []
        for transfer in ("{kind: amplitude}", curve):
            done = sonject.done(*verb, scene, "--set", "input.path=grey.png", "--set",
                                f"input.transfer={transfer}")
            told.append(done.stdout + done.stderr)
        assert told[0].count(note + curve) == 1 and note not in told[1]


def test_ground_range_and_back(sonject, tmp_path, line, sides):
    sonject.done("convert", "line.xtf", "g.tif", "--channel", "port", "--range-axis", "ground")
    told = (tmp_path / "g.tif").read_bytes()
    assert b"sonject:range_axis=ground" in told and b"first_ground_range_m=0\n" in told
    assert b"sonject:resampled=nearest column" in told and b"first_slant" not in told
    ground = images.read_tiff(tmp_path / "g.tif")
    last = numpy.sqrt((SPACING * (COLUMNS - 0.5)) ** 2 - ALTITUDE**2)
    assert ground.shape == (ROWS, int(last / SPACING) + 1)
    slant = numpy.hypot(SPACING * numpy.arange(ground.shape[1]), ALTITUDE)
    nearest = numpy.floor((slant - SPACING / 2) / SPACING + 0.5).astype(int)
    assert numpy.array_equal(ground, sides[0][:, nearest])
    sonject.done("convert", "g.tif", "s.tif", "--range-axis", "slant")
    back = images.read_tiff(tmp_path / "s.tif")
    # at far range each column of the one image is a column of the other
    first = COLUMNS - back.shape[1]
    assert 0 < first <= ALTITUDE / SPACING + 1
    offset = ALTITUDE / SPACING - 0.5
    same = [numpy.array_equal(back[:, j], sides[0][:, int(round(offset + j)) + k])
            for j in range(60, back.shape[1] - 2) for k in (-1, 0, 1)]
    assert sum(same) == back.shape[1] - 62
    assert_refused(sonject("convert", "g.tif", "x.tif", "--range-axis", "ground"), 3,
                   "in ground range already")
    assert_refused(sonject("convert", "g.tif", "x.tif", "--row-spacing", 0.1, "--column-spacing",
                           0.25, "--first-range", 7), 3, "says that it is in ground range")
    write_text(tmp_path, "path: g.tif", "row_spacing: 0.1 m, column_spacing: 0.25 m, first_slant_range: 7 m", BALL, "6 m", SONAR)
    assert_refused(sonject("run", "scene.yaml", "-o", "out"), 3, "ground range",
                   "sonject convert --range-axis slant")


def test_an_image_that_states_no_axis_is_in_ground_range_if_slant_range_is_asked_for(sonject, tmp_path):
    """Each column holds its own number. Its place follows from Pythagoras, and the new file needs no more numbers."""
    numbers = numpy.tile(numpy.arange(200, dtype=numpy.uint8), (20, 1))
    (tmp_path / "ground.tif").write_bytes(images.tiff_bytes(numbers))
    given = ["--first-range", "12m", "--row-spacing", "10cm", "--column-spacing", "5cm"]
    assert_refused(sonject("convert", "ground.tif", "slant.tif", "--range-axis", "slant", *given), 3, "altitude")
    sonject.done("convert", "ground.tif", "slant.tif", "--range-axis", "slant", *given, "--altitude", "9m")
    slant = 15.0 + 0.05 * numpy.arange(images.read_tiff(tmp_path / "slant.tif").shape[1])  # 9, 12, 15
    expected = numpy.rint((numpy.sqrt(slant**2 - 9**2) - 12.0) / 0.05)
    assert slant[-1] == pytest.approx(numpy.hypot(12 + 0.05 * 199, 9), abs=0.051)
    assert abs(images.read_tiff(tmp_path / "slant.tif")[7] - expected).max() == 0
    (tmp_path / "scene.yaml").write_text(f"""sonject: 1
input: {{path: slant.tif, transfer: {{kind: amplitude}}, geometry: from_file}}
sonar: {{altitude: from_file, {SONAR}}}
objects: [{BALL}]
""")
    assert "altitude 9 m" in sonject.done("check", "scene.yaml").stdout


def test_a_recording_that_says_ground_range(sonject, tmp_path, line):
    data = bytearray(line.read_bytes())
    for channel in range(3):
        struct.pack_into("<H", data, 256 + 128 * channel + 2, 2)
    line.write_bytes(data)
    sonject.done("convert", "line.xtf", "a.tif", "--channel", "port")
    assert b"sonject:range_axis=ground" in (tmp_path / "a.tif").read_bytes()


@pytest.mark.parametrize("arguments, code, words", [
    (["plain.npy", "x.tif", "--range-axis", "ground", "--altitude", 6], 3, "where its columns lie"),
    (["plain.npy", "x.npy", "--altitude", 6], 3, "keeps no geometry"),
    (["plain.npy", "x.tif", "--channel", "port"], 3, "neither XTF nor JSF"),
    (["plain.npy", "x.tif", "--array", "a"], 3, "neither HDF5 nor MATLAB"),
    (["plain.npy", "x.jpg"], 3, "without loss as .tif, .png, .npy or .h5"),
    (["plain.npy", "x.xtf", "--into", "line.xtf", "--channel", "port"], 3, "must be alike"),
    (["line.xtf", "x.tif", "--channel", "port", "--range-axis", "slant"], 3, "slant range already"),
    (["line.xtf", "x.tif"], 3, "choose one by input.channel or --channel, 1 (port), 2 (starboard)"),
    (["line.xtf", "x.xtf", "--into", "line.xtf", "--channel", "port", "--db", "-60:0"], 3, "grey levels need a new file"),
    (["plain.npy", "x.pgm"], 3, "without loss as .tif, .png, .npy or .h5"),
    (["plain.npy"], 2, "OUT is missing"),
    (["plain.npy", "x.tif", "y.tif"], 2, "takes IN and OUT; what is"),
])
def test_refusals(sonject, tmp_path, line, arguments, code, words):
    numpy.save(tmp_path / "plain.npy", numpy.ones((4, 5), numpy.float32))
    before = sorted(tmp_path.iterdir())
    assert_refused(sonject("convert", *arguments), code, words)
    assert sorted(tmp_path.iterdir()) == before
