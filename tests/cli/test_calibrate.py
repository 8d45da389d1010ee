"""Tests of sonject calibrate, which measures a swath's properties on the swath itself."""

import json
import os
import re

import numpy
import pytest

from conftest import assert_refused, write_text
from images import png_bytes
from made_swaths import COLUMNS, KINDS, ROWS, Made, deviations, sidescan, speckle
from measured_images import measured, read_png, read_xtf
from recordings import xtf_bytes


def calibrated(sonject, *arguments):
    answer = sonject("calibrate", "--json", *arguments)
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


@pytest.mark.parametrize("kind", KINDS)
def test_a_made_swath_tells_what_made_it(kind, sonject, tmp_path):
    """For each curve, tests one case of test_calibration_matrix.py: five estimates are within 4 standard
    errors. One swath of 3,000 lies beyond."""
    made = Made(kind, looks=1 if kind == "decibel" else 2)
    numpy.save(tmp_path / "made.npy", made.numbers)
    found = calibrated(sonject, "made.npy")
    assert found["input"]["transfer"]["kind"] == kind
    assert found["input"]["transfer"]["full_scale"] == made.ceiling
    assert found["measured"]["clipped"]["value"] == pytest.approx(made.clipped, rel=1e-3)
    for name, (deviation, width) in deviations(made, found["measured"]).items():
        assert abs(deviation) < 4 and width < 1, (name, deviation, width)
    assert found["injection"]["match"]["looks"] == found["measured"]["looks"]["value"]
    floor = found["measured"]["noise_floor"]["value"]
    assert found["injection"]["noise_floor"] == f"{floor:g} dB"


def test_wide_speckle_tells_what_made_it(sonject, tmp_path):
    """Tests speckle 3 pixels wide. A tile holds few grains. If chance chose tiles with little speckle, all curves
    would err by four standard errors to one side, and responses to the other."""
    found = []
    for seed in (1, 2):
        for kind in ("gamma", "schlick", "decibel"):
            made = Made(kind, seed=seed, width=3.0)
            numpy.save(tmp_path / "made.npy", made.numbers)
            measured = calibrated(sonject, "made.npy")["measured"]
            found.append({name: deviation for name, (deviation, _) in deviations(made, measured).items()})
            assert all(abs(deviation) < 4 for deviation in found[-1].values()), (kind, found[-1])
    for name in ("parameter", "response_along_track", "response_range"):
        assert abs(numpy.mean([one[name] for one in found])) < 2, (name, found)


def test_the_same_swath_tells_the_same_in_every_form(sonject, tmp_path):
    made = Made("schlick", bits=8)
    numpy.save(tmp_path / "made.npy", made.numbers)
    numpy.save(tmp_path / "floats.npy", made.numbers.astype(numpy.float32))
    (tmp_path / "made.png").write_bytes(png_bytes(made.numbers))
    answers = [calibrated(sonject, name) for name in ("made.npy", "made.png", "floats.npy")]
    for answer in answers:
        del answer["measured"]["swath"], answer["measured"]["swath_xxh3"]
    assert answers[0] == answers[1] == answers[2]


def test_texture_is_told_where_there_is_some(sonject, tmp_path):
    """The shape is measured on plain tiles. It is above the whole swath's, 3 and 6, and in the same order."""
    shapes = []
    for textures in (6, 12, None):
        numpy.save(tmp_path / "made.npy", speckle(3, textures=textures))
        shapes.append(calibrated(sonject, "made.npy")["measured"]["k_shape"])
    assert "no texture" in shapes[2]["not_seen"]
    (rough, smooth), errors = ([shape[key] for shape in shapes[:2]] for key in ("value", "standard_error"))
    assert 3 < rough < smooth - 2 * errors[1] < smooth < 60 and 6 < smooth and errors[0] < 0.2 * rough


def test_gain_against_range_is_told(sonject, tmp_path):
    numpy.save(tmp_path / "made.npy", speckle(3, gain_db=-6))
    gain = calibrated(sonject, "made.npy")["measured"]["gain"]
    columns, decibels, errors = (numpy.array(gain[key], float) for key in ("columns", "decibels", "standard_error"))
    is_told = numpy.isfinite(decibels)
    assert len(decibels) == 18 and is_told.sum() > 15 and numpy.median(errors[is_told]) < 0.3
    off = (decibels + 6 * columns / 600)[is_told]
    # The error is 0.1 dB: a band has some 8 of 144 tiles, each of 300 independent pixels.
    assert abs(off - numpy.median(off)).max() < 0.6


def test_curves_that_one_level_cannot_tell_apart_are_named(sonject, tmp_path):
    """Over speckle's spread, a Schlick curve of the parameter 3 is nearly a power. Over many levels it is not."""
    numpy.save(tmp_path / "one.npy", speckle(3, schlick=3))
    one = calibrated(sonject, "one.npy")["measured"]["transfer"]
    assert one["kind"] == "schlick" and one["parameter"]["value"] == pytest.approx(4, abs=1)
    (alike,) = one["cannot_be_told_from"]
    kind, exponent = alike.split()
    assert kind == "gamma" and 1.6 < float(exponent) < 1.9
    numpy.save(tmp_path / "many.npy", Made("schlick").numbers)
    assert calibrated(sonject, "many.npy")["measured"]["transfer"]["cannot_be_told_from"] == []


def test_a_misfit_tells_what_no_law_of_speckle_explains(sonject, tmp_path):
    """Amplitudes above the middle are stretched, so the curve is of no known family."""
    plain = speckle(3)
    bent = numpy.where(plain < 7000, plain, numpy.clip(3.0 * plain - 14000, 0, 65535)).astype(numpy.uint16)
    told = []
    for numbers in (plain, bent):
        numpy.save(tmp_path / "made.npy", numbers)
        told.append(calibrated(sonject, "made.npy")["measured"]["transfer"]["misfit"])
    assert told[0]["fits"] and told[0]["value"] < 0.005 and 0 < told[0]["standard_error"] < 0.002
    assert not told[1]["fits"] and told[1]["value"] > 0.05
    write_text(tmp_path, "path: made.npy, calibration: auto", "row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 30 m")
    for command in ["calibrate", "made.npy"], ["run", "scene.yaml", "-o", "out"]:
        (note,) = re.findall("note: (made.npy: the measured grey-level curve does not explain .*)", sonject.done(*command).stderr)
        assert f"{100 * told[1]['value']:.2g} % of its pixels are off" in note and "as input.transfer" in note


def test_where_nothing_clips_the_largest_number_is_the_ceiling(sonject, tmp_path):
    numbers = numpy.minimum(speckle(3), 60000)
    numpy.save(tmp_path / "made.npy", numbers.astype(numpy.uint16))
    measured = calibrated(sonject, "made.npy")["measured"]
    assert "not_seen" in measured["full_scale"]
    room = 20 * numpy.log10(65535 / numpy.sqrt(numpy.mean(numbers.astype(float) ** 2)))
    assert measured["ceiling_over_seabed"]["value"] == pytest.approx(room, abs=0.3)


def test_no_file_replaces_a_pipe(sonject, tmp_path):
    """A rename would replace the name of a pipe or a device, even /dev/null, and its readers would hear nothing."""
    numpy.save(tmp_path / "made.npy", Made("amplitude").numbers)
    os.mkfifo(tmp_path / "pipe")
    assert_refused(sonject("calibrate", "made.npy", "-o", "pipe"), 2, "pipe: is a pipe or a device")
    assert (tmp_path / "pipe").is_fifo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["made.npy", "pipe"]


def test_complex_pixels_have_no_curve(sonject, tmp_path):
    random = numpy.random.default_rng(2)
    field = random.standard_normal((256, 256, 2)).view(numpy.complex128)[..., 0]
    numpy.save(tmp_path / "field.npy", field.astype(numpy.complex64))
    found = calibrated(sonject, "field.npy")
    assert found["input"]["transfer"] == {"kind": "amplitude"}
    assert found["measured"]["looks"]["value"] == pytest.approx(1, abs=0.05)
    assert "complex" in found["measured"]["full_scale"]["not_seen"]
    assert "independent" in found["measured"]["response_range"]["not_seen"]


def test_what_is_not_there_is_not_seen_and_the_reason_told(sonject, tmp_path):
    numpy.save(tmp_path / "small.npy", numpy.full((40, 40), 7, numpy.uint8))
    found = calibrated(sonject, "small.npy")
    assert set(found) == {"sonject_calibration", "measured"}
    unseen = {name for name, told in found["measured"].items()
              if isinstance(told, dict) and told.get("not_seen")}
    assert unseen >= {"transfer", "full_scale", "looks", "noise_floor", "response_range", "altitude"}


def test_water_columns_of_one_side_and_two(sonject, tmp_path):
    """Speckle shows the first return of a ping to a sample, and the nadir, from 768 pings, much better."""
    rows = numpy.arange(ROWS)
    water = numpy.round(120 + 40 * numpy.sin(rows / 90)).astype(int)
    right = Made("amplitude", water=water, seed=5).numbers
    left = Made("amplitude", water=water, seed=6).numbers[:, ::-1]
    spacing = ("--row-spacing", "0.1", "--column-spacing", "0.05", "--first-range", "0.025")
    for name, numbers, sides in (("right", right, "one, range grows to the right"),
                                 ("left", left, "one, range grows to the left"),
                                 ("wide", numpy.hstack([Made("amplitude", seed=7).numbers, left]),
                                  "one, range grows to the left"),
                                 ("both", numpy.hstack([left[:, 300:], right]), "two")):
        numpy.save(tmp_path / f"{name}.npy", numbers)
        found = calibrated(sonject, f"{name}.npy", *spacing)
        told = found["measured"]
        assert told["sides"] == sides and told["first_return_every"] == 1
        off = numpy.abs(numpy.array(told["first_return"]) - water)
        assert numpy.mean(off <= 2) > 0.95, (name, numpy.sort(off)[-40:])
        assert told["altitude"]["value"] == pytest.approx(0.05 * (numpy.median(water) + 0.5), abs=0.06)
        assert found["sonar"]["altitude"] == f"{told['altitude']['value']:g} m"
        if sides == "two":
            nadir = told["nadir_column"]
            assert abs(nadir["value"] - (COLUMNS - 300 - 0.5)) < 3 * nadir["standard_error"] + 0.25
            assert found["input"]["geometry"] == {"nadir_column": nadir["value"]}
        else:
            assert "one side" in told["nadir_column"]["not_seen"]
        if sides.endswith("left"):  # to half a column, also for wide swaths
            assert found["input"]["geometry"] == {"nadir_column": numbers.shape[1] - 0.5}


def test_shadows_tell_the_noise_floor_and_the_water_column_does_not(sonject, tmp_path):
    for shadow_db in (-10.0, -14.0, -25.0):
        numpy.save(tmp_path / "shadows.npy", sidescan(shadow_db))
        found = calibrated(sonject, "shadows.npy")
        floor = found["measured"]["noise_floor"]
        assert found["measured"]["sides"] == "two" and 12 <= floor["shadows"] <= 24
        assert abs(floor["value"] - shadow_db) < 2 * floor["standard_error"] < 1.6, (shadow_db, floor)
    numpy.save(tmp_path / "none.npy", sidescan())
    none = calibrated(sonject, "none.npy")
    assert none["measured"]["sides"] == "two" and "noise_floor" not in none["injection"]
    assert "the water column is not a shadow" in none["measured"]["noise_floor"]["not_seen"]


def test_first_returns_of_long_swaths_are_told_of_some_pings(sonject, tmp_path):
    """Every third ping is told, so few that a scene can read them."""
    water = numpy.where(numpy.arange(41000) < 30000, 60, 70)
    random = numpy.random.default_rng(3)
    numbers = random.rayleigh(30, (len(water), 160)) * (numpy.arange(160) >= water[:, None])
    numpy.save(tmp_path / "long.npy", numpy.round(numbers).astype(numpy.uint8))
    told = calibrated(sonject, "long.npy")["measured"]
    assert told["first_return_every"] == 3 and len(told["first_return"]) == 13667
    off = numpy.abs(numpy.array(told["first_return"]) - water[::3])
    assert numpy.mean(off <= 2) > 0.95


def test_yaml_says_what_json_says(sonject, tmp_path):
    """Compares lines of the YAML. test_calibration_key.py reads the YAML by a scene."""
    numpy.save(tmp_path / "made.npy", Made("decibel").numbers)
    found = calibrated(sonject, "made.npy")
    answer = sonject("calibrate", "made.npy", "-o", "made.yaml", "--picture", "made.png")
    assert answer.returncode == 0 and answer.stdout == ""
    lines = (tmp_path / "made.yaml").read_text().splitlines()
    transfer = found["input"]["transfer"]
    assert f"    parameter: {transfer['parameter']:g}" in lines
    assert f"    full_scale: {transfer['full_scale']}" in lines
    assert f"  noise_floor: {found['injection']['noise_floor']}" in lines
    assert "      fits: true" in lines and f"      shadows: {found['measured']['noise_floor']['shadows']}"[2:] in lines
    assert (tmp_path / "made.png").read_bytes()[:4] == b"\x89PNG"


# The gaps take more keys of the input, the altitude, and objects.
LINE_SCENE = """\
sonject: 1
input: {path: line.xtf, %s, geometry: from_file}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: %s}
objects: [%s]
"""


def water_line(folder, share):
    """Writes a line whose recorded altitudes are that share of its first returns."""
    first = numpy.linspace(100, 140, ROWS)
    made = Made("amplitude", water=first).numbers
    (folder / "line.xtf").write_bytes(xtf_bytes(made, made, altitudes=share * first * 30 / COLUMNS, slant_range=30.0))


@pytest.mark.parametrize("share, told", [(0.85, "1[456] % below the first return"), (1.15, "1[456] % above the first return"), (1.0, None)])
def test_altitudes_that_first_returns_deny_are_told(sonject, tmp_path, share, told):
    water_line(tmp_path, share)
    answer = sonject.done("calibrate", "line.xtf", "--channel", "port", "-o", "port.yaml")
    (tmp_path / "scene.yaml").write_text(LINE_SCENE % ("channel: port, calibration: port.yaml", "from_file", "{shape: sphere, diameter: 0.4 m}"))
    texts = [answer.stderr, sonject.done("check", "scene.yaml").stdout]
    assert [text.count("first return") > 0 for text in texts] == [told is not None] * 2
    if told is None:
        return
    assert all(re.search(told, text) for text in texts)
    assert ["write sonar.altitude: first_return" in text for text in texts] == [False, True]  # calibrate knows of no scene
    by_returns = sonject.done("check", "scene.yaml", "--set", "sonar.altitude=first_return").stdout
    assert "the recorded altitude" not in by_returns
    assert altitude_of(by_returns) == pytest.approx(120 * 30 / COLUMNS, rel=0.02)  # the ball is in the middle


def altitude_of(checked):
    return float(re.search(r"altitude (\S+) m", checked)[1])


def test_altitudes_by_first_returns_are_those_at_the_objects(sonject, tmp_path):
    """First returns go from 100 columns at the first ping to 140 at the last. Recorded altitudes are far off."""
    water_line(tmp_path, 0.5)
    for side in ("port", "starboard"):
        sonject.done("calibrate", "line.xtf", "--channel", side, "-o", f"{side}.yaml")
    (tmp_path / "scene.yaml").write_text(LINE_SCENE % (
        "channel: port, calibration: port.yaml", "first_return", "{shape: sphere, diameter: 0.4 m, position: {row: 20, column: 300}}"))
    column = 30 / COLUMNS
    at = [100 * column, (100 + 40 * 20 / (ROWS - 1)) * column, 120 * column, 140 * column]
    assert altitude_of(sonject.done("check", "scene.yaml").stdout) == pytest.approx(at[1], rel=0.02)
    two = "objects=[{shape: sphere, diameter: 0.4 m, position: {row: 0, column: 300}}, " \
          "{shape: sphere, diameter: 0.4 m, position: {row: 767, column: 300}}]"
    told = re.search(r"the altitude varies from (\S+) to (\S+) m over the objects' pings",
                     sonject.done("check", "scene.yaml", "--set", two).stdout)
    assert [float(number) for number in told.groups()] == pytest.approx([at[0], at[3]], rel=0.02)
    patch = sonject.done("check", "scene.yaml", "--set", "patch={row: 300, column: 200, rows: 168, columns: 512}", "--set",
                         "objects=[{shape: sphere, diameter: 0.4 m, position: {row: 310, column: 300}}]").stdout
    assert altitude_of(patch) == pytest.approx(at[2], rel=0.01)  # mean of rows 300 to 467
    sonject.done("run", "scene.yaml", "-o", "out")
    found = json.loads((tmp_path / "out" / "truth.json").read_text())["numbers"]["altitude_m"]
    assert found == {"value": pytest.approx(at[1], rel=0.02), "from": "calibration"}


def test_first_returns_are_those_of_the_mirrored_image(sonject, tmp_path):
    """Range 0 is at the centre of the nearest column, or at the image's edge, half a column before it."""
    numbers = Made("amplitude", water=numpy.full(ROWS, 120)).numbers
    answers = {}
    for name, pixels in ("right", numbers), ("left", numbers[:, ::-1]):
        numpy.save(tmp_path / f"{name}.npy", pixels)
        sonject.done("calibrate", f"{name}.npy", "-o", f"{name}.yaml")
    for name, places in (("right", "first_slant_range: 0 m"), ("left", f"first_slant_range: 0 m, nadir_column: {COLUMNS - 1}"),
                         ("edge", f"nadir_column: {COLUMNS - 0.5}"), ("mistaken", "first_slant_range: 0 m")):
        file = "right" if name == "right" else "left"
        write_text(tmp_path, f"path: {file}.npy, calibration: {file}.yaml", f"row_spacing: 10 cm, column_spacing: 2 cm, {places}",
                   "{shape: sphere, diameter: 0.4 m}", "first_return", "frequency: 100 kHz, bandwidth: 37.5 kHz")
        answer = sonject.done("check", "scene.yaml")
        answers[name] = altitude_of(answer.stdout)
        is_noted = "left.yaml found the water column at the image's right edge, and here range grows to the right" in answer.stdout
        assert is_noted == (name == "mistaken")
    assert answers["left"] == answers["right"] == pytest.approx(2.4, abs=0.025)
    assert answers["edge"] == pytest.approx(answers["right"] + 0.01, abs=1e-3)


@pytest.mark.parametrize("is_far_first", [True, False])
def test_a_recording_whose_port_side_is_stored_from_near_to_far_is_noted(sonject, tmp_path, is_far_first):
    """XTF files hold port from far to near. In one that does not, the water column lies at the far end."""
    numbers = Made("amplitude", water=numpy.full(ROWS, 120)).numbers
    port = numbers if is_far_first else numbers[:, ::-1]
    (tmp_path / "line.xtf").write_bytes(xtf_bytes(port, numbers))
    sonject.done("calibrate", "line.xtf", "--channel", "port", "-o", "line.yaml")
    scene = tmp_path / "scene.yaml"
    scene.write_text(f"""sonject: 1
input: {{path: line.xtf, channel: port, calibration: line.yaml, geometry: from_file}}
sonar: {{altitude: first_return, frequency: 100 kHz, bandwidth: 37.5 kHz}}
objects: [{{shape: sphere, diameter: 0.4 m, position: {{row: {ROWS // 2}, column: {COLUMNS // 2}}}}}]
""")
    note = "found the water column at the image's right edge"
    assert (note in sonject.done("check", "scene.yaml").stdout) == (not is_far_first)
    if not is_far_first:  # what the note says helps
        text = scene.read_text().replace(
            "from_file", f"{{row_spacing: 10 cm, column_spacing: 5 cm, nadir_column: {COLUMNS - 0.5}, side: port}}")
        scene.write_text(text)
        assert note not in sonject.done("check", "scene.yaml").stdout


def test_first_returns_of_another_swath_are_noted(sonject, tmp_path):
    """A second line beside the first one takes the first one's calibration from the scene, and so its altitudes."""
    for name, water in ("one", 120), ("two", 90):
        numbers = Made("amplitude", water=numpy.full(ROWS, water)).numbers
        (tmp_path / f"{name}.xtf").write_bytes(xtf_bytes(numbers, numbers))
        sonject.done("calibrate", f"{name}.xtf", "--channel", "port", "-o", f"{name}.yaml")
    (tmp_path / "scene.yaml").write_text("""sonject: 1
input: {path: one.xtf, channel: port, calibration: one.yaml, geometry: from_file}
sonar: {altitude: first_return, frequency: 100 kHz, bandwidth: 37.5 kHz}
objects: [{shape: sphere, diameter: 0.4 m}]
""")
    note = "one.yaml was measured on another swath than two.xtf"
    answers = {calibration: sonject.done("check", "scene.yaml", "--set", "input.path=two.xtf", "--set", f"input.calibration={calibration}.yaml")
               for calibration in ("one", "two")}
    assert note in answers["one"].stdout and "another swath" not in answers["two"].stdout
    assert "another swath" not in sonject.done("check", "scene.yaml").stdout
    assert "another swath" not in sonject.done("check", "scene.yaml", "--set", "input.path=two.xtf", "--set", "sonar.altitude=from_file").stdout
    for calibration in "one", "two":
        (tmp_path / "campaign.yaml").write_text(f"""sonject_campaign: 1
scene: scene.yaml
images: 2
chip: {{rows: 32, columns: 64}}
swaths:
  - {{path: one.xtf}}
  - {{path: two.xtf, set: {{input.calibration: {calibration}.yaml}}}}
targets: [{{class: ball, object: {{shape: sphere, diameter: 0.4 m}}}}]
""")
        for arguments in ["check", "campaign.yaml"], ["campaign", "campaign.yaml", "-o", calibration]:
            assert (note in sonject.done(*arguments).stderr) == (calibration == "one")


def test_both_sides_first_returns_begin_at_the_nadir(sonject, tmp_path):
    made = Made("amplitude", water=numpy.full(ROWS, 120)).numbers
    numpy.save(tmp_path / "both.npy", numpy.hstack([made[:, ::-1], made]))
    sonject.done("calibrate", "both.npy", "-o", "both.yaml")
    write_text(tmp_path, "path: both.npy, calibration: both.yaml", "row_spacing: 5 cm, column_spacing: 5 cm, side: port",
               altitude="first_return")
    columns = numpy.mean(calibrated(sonject, "both.npy")["measured"]["first_return"])
    assert columns == pytest.approx(120, abs=1)
    # measured to the centre of the seabed's first pixel; check prints three digits
    assert altitude_of(sonject.done("check", "scene.yaml").stdout) == pytest.approx((columns + 0.5) * 0.05, abs=0.006)


def test_the_nadir_is_found_beside_a_far_range_that_is_darker(sonject, tmp_path):
    """Far seabed falls below the level of the water column, as in a recording without gain."""
    made = Made("amplitude", water=numpy.full(ROWS, 120)).numbers.astype(float)
    made[:, -60:] *= 0.004
    both = numpy.maximum(numpy.hstack([made[:, ::-1], made]), 1)
    numpy.save(tmp_path / "both.npy", both.astype(numpy.uint16))
    nadir = calibrated(sonject, "both.npy")["measured"]["nadir_column"]
    assert nadir["value"] == pytest.approx(made.shape[1] - 0.5, abs=1)


@pytest.mark.parametrize("key, why", [
    ("input.calibration=auto", "first_return needs a calibration that already exists"),
    ("input.calibration=none.yaml", "first_return needs an input.calibration that has first returns"),
    ("input.calibration=short.yaml", "short.yaml has first returns of another image, not of one with")])
def test_altitudes_need_first_returns(sonject, tmp_path, key, why):
    water_line(tmp_path, 1.0)
    (tmp_path / "none.yaml").write_text("sonject_calibration: 1\ninput: {transfer: {kind: amplitude}}\n")
    (tmp_path / "short.yaml").write_text("sonject_calibration: 1\nmeasured: {first_return_every: 1, first_return: [100, 101]}\n")
    (tmp_path / "scene.yaml").write_text(LINE_SCENE % ("channel: port", "first_return", ""))
    assert_refused(sonject("check", "scene.yaml", "--set", key), 3, why)


def test_the_other_sides_calibration_is_told(sonject, tmp_path):
    water_line(tmp_path, 1.0)
    for side in ("port", "starboard"):
        sonject.done("calibrate", "line.xtf", "--channel", side, "-o", f"{side}.yaml")
    (tmp_path / "scene.yaml").write_text(LINE_SCENE % ("channel: port", "from_file", ""))
    for side, note in ("port", ""), ("starboard", "starboard.yaml was measured on the starboard side, and this is port"):
        for verb in ["check"], ["run", "-o", side]:
            answer = sonject.done(verb[0], "scene.yaml", *verb[1:], "--set", f"input.calibration={side}.yaml")
            assert note in answer.stdout + answer.stderr and ("was measured on" in answer.stdout + answer.stderr) == bool(note)
    (tmp_path / "campaign.yaml").write_text(
        "sonject_campaign: 1\nscene: scene.yaml\nimages: 2\nchip: {rows: 64, columns: 64}\nempty: 1\nsplits: {all: 1}\n"
        "swaths: [{path: line.xtf}, {path: line.xtf, set: {input.channel: starboard}}]\n"
        "targets: [{class: ball, object: {shape: sphere, diameter: 40 cm}}]\n")
    (tmp_path / "scene.yaml").write_text((tmp_path / "scene.yaml").read_text().replace(
        "geometry", "calibration: port.yaml, geometry"))
    notes = [line for line in sonject.done("campaign", "campaign.yaml", "-o", "set").stderr.splitlines() if "note" in line]
    assert len(notes) == 1 and "port.yaml was measured on the port side, and this is starboard" in notes[0]


def test_bad_input_is_refused(sonject, tmp_path):
    numpy.save(tmp_path / "nan.npy", numpy.full((64, 64), numpy.nan, numpy.float32))
    numpy.save(tmp_path / "made.npy", numpy.zeros((64, 64), numpy.float32))
    assert_refused(sonject("calibrate", "nan.npy"), 3, "row 0, column 0", "not a finite number")
    assert_refused(sonject("calibrate", "none.npy"), 3, "none.npy")
    assert_refused(sonject("calibrate", "made.npy", "--row-spacing", "1"), 2, "belong together")
    assert_refused(sonject("calibrate", "made.npy", "-o", "no/folder/a.yaml"), 5, "no/folder")


def plain_parameter(image):
    """Returns the Schlick parameter that gives the plainer half of an image's tiles the median contrast of
    one look."""
    side, part = 32, 8
    rows, columns = (size // side for size in image.shape)
    tiles = image[: rows * side, : columns * side].astype(float).reshape(rows, side, columns, side)
    tiles = tiles.swapaxes(1, 2).reshape(-1, side, side) / 255
    parts = tiles.reshape(-1, 4, part, 4, part).swapaxes(2, 3).reshape(-1, 16, part * part)
    quartiles = numpy.percentile(tiles.reshape(-1, side * side), [25, 75], axis=1)
    unevenness = numpy.median(parts, 2).std(1) / (quartiles[1] - quartiles[0])
    plain = tiles[unevenness <= numpy.median(unevenness)].reshape(-1, side * side)
    low, high = 1.0, 20.0
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        amplitudes = plain / (middle - (middle - 1) * plain)
        contrast = numpy.median(amplitudes.std(1) / amplitudes.mean(1))
        low, high = (middle, high) if contrast < (4 / numpy.pi - 1) ** 0.5 else (low, middle)
    return low


@pytest.mark.parametrize("name", ["image_02", "image_11", "sassed44_1001x1001_original"])
def test_a_measured_curve_is_what_plain_patches_need(name, sonject):
    path = measured(f"sassed/{name}.png")
    found = calibrated(sonject, path)["input"]["transfer"]
    assert found["kind"] == "schlick"
    assert found["parameter"] == pytest.approx(plain_parameter(read_png(path)), abs=0.3)


def test_measured_decibels_a_grey_level(sonject):
    """The contrast of plain patches gives 0.378. So do 16 bits of amplitude on 255 levels."""
    found = calibrated(sonject, measured("sas/hisas2040_wreck_6079x3578.jpg"))["input"]["transfer"]
    assert found["kind"] == "decibel"
    assert found["parameter"] == pytest.approx(0.378, rel=0.03)


def test_measured_clipping_and_first_returns(sonject):
    """Compares the sides with each other. The line's recorded altitudes come from another sensor and are
    10 to 60 samples short of both sides' seabed."""
    path = measured("sidescan/scotsman-iver2.xtf")
    found = [calibrated(sonject, path, "--channel", side) for side in ("port", "starboard")]
    samples, _ = read_xtf(path)
    for side in found:
        assert side["input"]["transfer"]["full_scale"] == 32767
    assert found[0]["measured"]["clipped"]["value"] == pytest.approx(numpy.mean(samples == 32767),
                                                                     rel=1e-3)
    port, starboard = (numpy.array(side["measured"]["first_return"]) for side in found)
    assert numpy.mean(numpy.abs(port - starboard) <= 4) >= 0.95
