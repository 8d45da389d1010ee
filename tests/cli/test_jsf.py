"""Tests of EdgeTech's JSF files as input: they are read, injected into and written back."""

import json
import os
import re
import subprocess

import numpy
import pytest

import images
import recordings
from conftest import assert_refused
from recordings import EXPLICIT, assert_patch_alone_changed, samples_of, write_scene

ROWS, COLUMNS = 60, 200


def analytic(random):
    return random.normal(0.0, 1500.0, (ROWS, COLUMNS, 2)).astype(numpy.int16)


def test_analytic_signals_are_complex_pixels(sonject, tmp_path):
    """The result is as for a TIFF of the same floats, rounded."""
    random = numpy.random.default_rng(3)
    port, starboard = analytic(random), analytic(random)
    (tmp_path / "line.jsf").write_bytes(recordings.jsf_bytes(port, starboard))
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(port.astype("<f4")))
    sonject.done("run", write_scene(tmp_path, "line.jsf", "port", "complex: true,"), "-o", "jsf")
    sonject.done("run", write_scene(tmp_path, "line.tif", "", "complex: true,", EXPLICIT, "6 m"), "-o", "tif")
    before = (tmp_path / "line.jsf").read_bytes()
    after = (tmp_path / "jsf" / "image.jsf").read_bytes()
    floats = images.read_tiff(tmp_path / "tif" / "image.tif").reshape(ROWS, COLUMNS, 2)
    assert numpy.array_equal(samples_of(after, 0)[0], numpy.clip(numpy.floor(floats + 0.5), -32767, 32767))
    assert_patch_alone_changed(before, after, 0)
    assert_refused(sonject("run", write_scene(tmp_path, "line.jsf", "port"), "-o", "out"), 3,
                   "has 2 channels: say complex: true")


def test_geometry_is_the_pings(sonject, tmp_path, sides):
    """Ranges follow from the first ping's sound speed and delay. Positions are in any of three units."""
    step = 0.1 / (1852 * 60) * 600000
    for units, places in ((1, [(100 * row, 5) for row in range(ROWS)]), (3, [(5, row) for row in range(ROWS)]),
                          (2, [(9.0, 600000 * 60 + step * row) for row in range(ROWS)])):
        # the units of an invalid position do not count
        data = b"".join(recordings.jsf_ping(line, 1, speed=1450.0 + row / 100, delay=20, position=place,
                                            units=units if row else 3 - units % 2, spacing=0.145,
                                            valid=0x49 if row else 0x48)
                        for row, (line, place) in enumerate(zip(sides[1], places)))
        (tmp_path / "line.jsf").write_bytes(data)
        answer = sonject.done("check", write_scene(tmp_path, "line.jsf"))
        assert "slant range 11.67...28.93 m, starboard" in answer.stdout
        assert float(re.search("([0-9.]+) m along-track", answer.stdout)[1]) == pytest.approx(4.0, abs=0.02)


def test_headings_place_targets(sonject, tmp_path, sides):
    """The target is abeam to port of a sonar that heads east while it moves north east."""
    (tmp_path / "line.jsf").write_bytes(recordings.jsf_bytes(*sides, heading=90.0))
    sonject.done("run", write_scene(tmp_path, "line.jsf", "port"), "-o", "out")
    found = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"][0]
    row, place = found["row"], found["position"]
    assert place["easting_m"] == pytest.approx(1000.0 + 0.06 * row, abs=0.01)
    assert place["northing_m"] == pytest.approx(2000.0 + 0.08 * row + found["ground_range_m"], abs=0.01)


def test_what_is_not_valid_is_not_there(sonject, tmp_path, sides):
    """The pings' own flags say which values are valid."""
    for valid, words in ((0x48, "fewer than two of its pings have a position"), (0x09, "has no altitudes")):
        (tmp_path / "line.jsf").write_bytes(recordings.jsf_bytes(*sides, valid=valid))
        assert_refused(sonject("check", write_scene(tmp_path, "line.jsf", "port")), 3, words)
    (tmp_path / "line.jsf").write_bytes(recordings.jsf_bytes(*sides, heading=90.0, valid=0x41))
    sonject.done("run", write_scene(tmp_path, "line.jsf", "port"), "-o", "out")
    found = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"][0]
    # without a heading, the track's course counts: 3 to the east for 4 to the north
    assert found["position"]["easting_m"] == pytest.approx(
        1000.0 + 0.06 * found["row"] - 0.8 * found["ground_range_m"], abs=0.01)


@pytest.mark.parametrize("row", [40, 200, 395])
def test_courses_bear_rounded_positions(sonject, tmp_path, row):
    """Pings 5 cm apart are placed to 185 mm, 1/10000 of a minute of arc."""
    line = numpy.random.default_rng(2).integers(1, 60000, (400, COLUMNS))
    positions = [(185 * round(30 * ping / 185), 185 * round(40 * ping / 185)) for ping in range(400)]
    (tmp_path / "line.jsf").write_bytes(b"".join(
        recordings.jsf_ping(samples.astype("<u2"), 0, position=(1e6 + x, 2e6 + y), number=ping)
        for ping, (samples, (x, y)) in enumerate(zip(line, positions))))
    (tmp_path / "scene.yaml").write_text(
        "sonject: 1\ninput: {path: line.jsf, channel: port, geometry: from_file}\n"
        "sonar: {frequency: 60 kHz, bandwidth: 5 kHz, altitude: from_file}\n"
        f"objects: [{{shape: sphere, diameter: 0.5 m, position: {{row: {row}, column: 150}}}}]\n")
    sonject.done("run", "scene.yaml", "-o", "out")
    found = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"][0]
    range_m = found["ground_range_m"]
    assert found["position"]["easting_m"] == pytest.approx(1000 + 0.03 * row - 0.8 * range_m, abs=0.01 * range_m + 0.1)
    assert found["position"]["northing_m"] == pytest.approx(2000 + 0.04 * row + 0.6 * range_m, abs=0.01 * range_m + 0.1)


def test_long_pings_have_more_bits(sonject, tmp_path):
    line = numpy.arange(70000, dtype=numpy.uint32) % 60000
    (tmp_path / "line.jsf").write_bytes(b"".join(one(line + row) for row in range(2)))
    sonject.done("convert", "line.jsf", "a.npy")
    assert numpy.array_equal(numpy.load(tmp_path / "a.npy"), [line, line + 1])


def test_a_file_of_several_subsystems_has_numbered_channels(sonject, tmp_path, sides):
    (tmp_path / "line.jsf").write_bytes(recordings.jsf_bytes(*sides, subsystems=(20, 21)))
    for channel in ("port", 4):
        assert_refused(sonject("check", write_scene(tmp_path, "line.jsf", channel)), 3,
                       "choose one by input.channel or --channel, 0 (port, subsystem 20), 1 (starboard, subsystem 20), "
                       "2 (port, subsystem 21), 3 (starboard, subsystem 21)")
    sonject.done("convert", "line.jsf", "a.npy", "--channel", "3")
    assert numpy.array_equal(numpy.load(tmp_path / "a.npy"), sides[1] + 1)


def one(line, **options):
    return recordings.jsf_ping(line.astype("<u2"), 0, position=(5, 5), **options)


REFUSALS = {
    "cut short": (lambda data, line: data[:-100], "the last message is cut short"),
    "half a head": (lambda data, line: data + data[:9], "the last message is cut short"),
    "no message": (lambda data, line: data + bytes(40), "no message where one should be"),
    "a short ping": (lambda data, line: recordings.jsf_message(80, bytes(239), 20, 0), "a ping is cut short"),
    "more samples": (lambda data, line: data[:56] + one(line)[:16 + 114] + b"\xff\xff" + one(line)[16 + 116:],
                     "more samples than the ping holds"),
    "another kind": (lambda data, line: one(line, kind=2), "channel 0 has samples of kind 2"),
    "kinds": (lambda data, line: one(line) + one(line[:100], kind=1),
              "ping 1 has samples of kind 1, the pings before it of kind 0"),
    "compressed": (lambda data, line: one(line, kind=257), "holds compressed samples"),
    "packets": (lambda data, line: one(line) + one(line, packet=2), "ping 1 is in several packets"),
    "other ranges": (lambda data, line: one(line) + one(line, spacing=0.2),
                     "ping 1 has 200 samples from 0 to 40 m, the first ping 200 from 0 to 30 m"),
    "another start": (lambda data, line: one(line) + one(line, delay=2),
                      "ping 1 has 200 samples from 0.3 to 30.3 m, the first ping 200 from 0 to 30 m"),
    "no ranges": (lambda data, line: one(line, spacing=0.0), "a ping without slant range"),
    "weights": (lambda data, line: one(line, weight=-40) + one(line, weight=30),
                "weighs its pings from 2^-30 to 2^40"),
    "no ping": (lambda data, line: one(line[:0]), "has no pings"),
    "no sidescan": (lambda data, line: recordings.jsf_ping(line, 0, 0), "has no sidescan channel"),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_damaged_and_other_files_are_refused(sonject, tmp_path, sides, case):
    make, words = REFUSALS[case]
    (tmp_path / "line.jsf").write_bytes(make(recordings.jsf_bytes(*sides), sides[0][0]))
    answer = sonject("run", write_scene(tmp_path, "line.jsf", "port"), "-o", "out")
    assert_refused(answer, 3, "line.jsf: ", words)
    assert not (tmp_path / "out").exists()


READER = """\
import os, sys, numpy
from pingverter.converter import jsf2pingmapper
for path in sys.argv[1:]:
    found = jsf2pingmapper(path, path + ".meta").header_dat
    for beam, side in ((2, "port"), (3, "starboard")):
        pings = found[(found.beam == beam) & (found.freq_band == "low")].sort_values("ping_number")
        starts = pings["index"] + pings["son_offset"]
        lines = [numpy.fromfile(path, "<i2", count, offset=start)
                 for start, count in zip(starts, pings["ping_cnt"])]
        numpy.savez(f"{path}.{side}.npz", samples=lines, **{
            name: pings[name] for name in ("altitude", "pixM", "e", "n", "instr_heading", "f")})
"""


def test_others_read_what_we_write(sonject, tmp_path):
    """pingverter finds in the written file the samples that sonject put there, and the numbers that
    sonject works with."""
    reader = os.environ.get("SONJECT_READERS")
    if not reader:
        pytest.skip("SONJECT_READERS does not name a Python that has pingverter")
    random = numpy.random.default_rng(3)
    port, starboard = analytic(random), analytic(random)
    (tmp_path / "line.jsf").write_bytes(recordings.jsf_bytes(port, starboard, heading=12.5))
    sonject.done("run", write_scene(tmp_path, "line.jsf", "port", "complex: true,"), "-o", "out")
    subprocess.run([reader, "-c", READER, tmp_path / "line.jsf", tmp_path / "out" / "image.jsf"], check=True,
                   env={**os.environ, "PYTHONPATH": ""}, stdout=subprocess.DEVNULL)
    before, after = (numpy.load(f"{tmp_path / path}.port.npz") for path in ("line.jsf", "out/image.jsf"))
    assert numpy.array_equal(before["samples"], port.reshape(ROWS, -1))
    ours, _ = samples_of((tmp_path / "out" / "image.jsf").read_bytes(), 0)
    assert numpy.array_equal(after["samples"], ours.reshape(ROWS, -1))
    changed = numpy.argwhere(before["samples"] != after["samples"])
    assert len(changed) > 100
    assert (changed.min(0) >= (10, 120)).all() and (changed.max(0) < (50, 360)).all()
    other = [numpy.load(f"{tmp_path / path}.starboard.npz")["samples"] for path in ("line.jsf", "out/image.jsf")]
    assert numpy.array_equal(*other) and numpy.array_equal(other[0], starboard.reshape(ROWS, -1))
    facts = json.loads((tmp_path / "out" / "truth.json").read_text())
    assert after["altitude"] == pytest.approx(6.0) and after["pixM"] == pytest.approx(0.15)
    assert after["instr_heading"] == pytest.approx(12.5) and after["f"] == pytest.approx(600.0)
    # 40 rows of 0.1 m along-track; the patch's near corner abeam of its first ping
    near, east, north = facts["patch"]["corners"][0], after["e"][10], after["n"][10]
    beside = 12.5 - 90.0
    ground = numpy.sqrt((0.075 + 60 * 0.15) ** 2 - 36.0)
    assert near["easting_m"] == pytest.approx(east + ground * numpy.sin(numpy.radians(beside)), abs=0.01)
    assert near["northing_m"] == pytest.approx(north + ground * numpy.cos(numpy.radians(beside)), abs=0.01)
