"""Tests of input.calibration: a scene takes values that it lacks from a calibration, and reports the source
of each value. `auto` makes a calibration."""

import json
import os
import signal
import subprocess
import time

import numpy
import pytest

from conftest import COMMAND, assert_refused, page_data
from images import png_bytes
from made_swaths import Made, sidescan
from test_campaign import contents

GEOMETRY = "{row_spacing: 5 cm, column_spacing: 2.5 cm, first_slant_range: 30 m}"
SCENE = f"""\
sonject: 1
input:
  path: swath.png
  geometry: {GEOMETRY}
  calibration: %s
sonar: {{frequency: 100 kHz, bandwidth: 30 kHz, %s}}
patch: {{row: 300, column: 300, rows: 96, columns: 128}}
objects: [{{name: ball, shape: sphere, diameter: 40 cm, material: steel}}]
"""
CALIBRATION = """\
# by hand
sonject_calibration: 1
input: {transfer: {kind: schlick, parameter: 3, full_scale: 230}}
sonar: {altitude: 9 m}
injection: {noise_floor: -24 dB, match: {looks: 2}}
measured: {whatever: [1, 2]}
"""
CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: 4
seed: 3
chip: {rows: 64, columns: 64}
swaths: [{path: swath.png}, {path: other.png}]
splits: {train: 0.5, val: 0.5}
outputs: []
targets: [{class: ball, object: {shape: sphere, diameter: 40 cm}}]
"""


def scene(folder, calibration="swath.yaml", sonar="altitude: 10 m", text=CALIBRATION):
    swath = Made("schlick", bits=8).numbers
    (folder / "swath.png").write_bytes(png_bytes(swath))
    (folder / "swath.yaml").write_text(text)
    (folder / "scene.yaml").write_text(SCENE % (calibration, sonar))


def run_document(sonject, folder, *arguments):
    answer = sonject("run", "scene.yaml", "-o", "out", "--verbose", *arguments)
    assert answer.returncode == 0, answer.stderr
    return json.loads((folder / "out" / "run.json").read_text())["numbers"], answer


def test_a_scene_takes_what_it_lacks_and_tells_it(sonject, tmp_path):
    scene(tmp_path)
    numbers, answer = run_document(sonject, tmp_path, "--set", "injection.match.looks=1")
    assert numbers == {
        "calibration": "swath.yaml",
        "transfer": {"kind": "schlick", "from": "calibration",
                     "parameter": {"value": 3.0, "from": "calibration"},
                     "full_scale": {"value": 230.0, "from": "calibration"}},
        "noise_floor_db": {"value": pytest.approx(-24), "from": "calibration"},
        "looks": {"value": 1.0, "from": "scene"},
        "altitude_m": {"value": 10.0, "from": "scene"},
        "seabed_lambert_db": {"value": pytest.approx(-27), "from": "default"},
    }
    truth = json.loads((tmp_path / "out" / "truth.json").read_text())
    assert truth["numbers"] == numbers
    assert "gives input.transfer.kind, input.transfer.parameter, input.transfer.full_scale" in answer.stderr


def test_a_calibrated_scene_is_the_one_that_says_the_same(sonject, tmp_path):
    scene(tmp_path, sonar="")
    taken, _ = run_document(sonject, tmp_path)
    assert taken["altitude_m"] == {"value": 9.0, "from": "calibration"}
    answer = sonject(
        "run", "scene.yaml", "-o", "said", "--set", f"input={{path: swath.png, geometry: {GEOMETRY}, "
        "transfer: {kind: schlick, parameter: 3, full_scale: 230}}", "--set", "sonar.altitude=9 m",
        "--set", "injection.noise_floor=-24 dB", "--set", "injection.match.looks=2")
    assert answer.returncode == 0, answer.stderr
    for name in ("image.png", "patch.tif"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "said" / name).read_bytes()


def test_a_curve_of_the_scenes_own_keeps_its_parameter(sonject, tmp_path):
    scene(tmp_path)
    numbers, _ = run_document(sonject, tmp_path, "--set", "input.transfer={kind: amplitude}")
    assert numbers["transfer"] == {"kind": "amplitude", "from": "scene",
                                   "full_scale": {"value": 230.0, "from": "calibration"}}


def test_a_nadir_is_the_images_and_a_first_range_the_scenes(sonject, tmp_path):
    scene(tmp_path, text=CALIBRATION.replace("input: {", "input: {geometry: {nadir_column: 99.5}, "))
    geometry = "input.geometry={row_spacing: 5 cm, column_spacing: 2.5 cm, side: starboard}"
    low = ("--set", "sonar.altitude=3 m", "--set")
    taken = sonject("check", "scene.yaml", *low, geometry)
    said = sonject("check", "scene.yaml", *low, geometry.replace("side", "nadir_column: 99.5, side"))
    kept = sonject("check", "scene.yaml")
    assert taken.returncode == said.returncode == kept.returncode == 0, taken.stderr + kept.stderr
    assert taken.stdout == said.stdout != kept.stdout


def test_a_floor_that_no_shadow_tells_is_named_a_fallback(sonject, tmp_path):
    scene(tmp_path)
    (tmp_path / "scene.yaml").write_text((SCENE % ("x", "altitude: 10 m")).replace("  calibration: x\n", ""))
    numbers, answer = run_document(sonject, tmp_path)
    assert numbers["noise_floor_db"] == {"value": pytest.approx(-22.5), "from": "fallback"}
    assert numbers["transfer"] == {"kind": "amplitude", "from": "default"}
    assert "no shadow in the patch shows the noise floor, so 22.5 dB under the mean seabed is assumed" in answer.stderr


def test_shadows_of_a_patch_tell_its_floor_and_the_water_column_does_not(sonject, tmp_path):
    """The patch begins 60 columns before the first return."""
    for shadow_db in (-14, None):
        numpy.save(tmp_path / "swath.npy", sidescan(shadow_db))
        text = (SCENE % ("x", "altitude: 10 m")).replace("  calibration: x\n", "").replace("swath.png", "swath.npy")
        text = text.replace(GEOMETRY, "{row_spacing: 10 cm, column_spacing: 10 cm, nadir_column: 499.5, "
                            "first_slant_range: 0 m, side: starboard}")
        (tmp_path / "scene.yaml").write_text(text.replace(
            "{row: 300, column: 300, rows: 96, columns: 128}", "{row: 0, column: 540, rows: 480, columns: 460}"))
        floor = run_document(sonject, tmp_path, "--overwrite")[0]["noise_floor_db"]
        # the floor of ten or more shadows, each known to 2 dB because of the seabed's texture and speckle
        assert floor == ({"value": pytest.approx(-14, abs=1.3), "from": "patch"} if shadow_db else
                         {"value": pytest.approx(-22.5), "from": "fallback"})


@pytest.mark.parametrize("text, words", [
    ("sonject: 1\n", ["swath.yaml:1:1", "sonject_calibration", "must be 1"]),
    (CALIBRATION + "seabed: {lambert: -20 dB}\n", ["swath.yaml:7:1", "seabed", "sections input, sonar"]),
    (CALIBRATION.replace("looks", "look"), ["swath.yaml:5", "injection.match.look", "did you mean 'looks'"]),
    (CALIBRATION.replace("parameter: 3", "parameter: 0.5"), ["scene.yaml:5", "input.transfer.parameter", "1..."]),
])
def test_what_is_wrong_in_it_is_told(text, words, sonject, tmp_path):
    scene(tmp_path, text=text)
    assert_refused(sonject("check", "scene.yaml"), 3, *words)


def test_other_mistakes(sonject, tmp_path):
    scene(tmp_path)
    assert_refused(sonject("check", "scene.yaml", "--set", "input.calibration=none.yaml"), 3, "none.yaml")
    assert_refused(sonject("trace", "scene.yaml", "-o", "sums", "--set", "input.calibration=auto"), 3,
                   "auto is for run and campaign")
    assert_refused(
        sonject("check", "scene.yaml", "--set",
                f"input={{uniform: {{rows: 96, columns: 128}}, calibration: a.yaml, geometry: {GEOMETRY}}}",
                "--set", "patch={rows: 96, columns: 128}"),
        3, "input.calibration", "belongs to an image file")


def test_auto_makes_one_and_keeps_it(sonject, tmp_path):
    scene(tmp_path, calibration="auto")
    numbers, answer = run_document(sonject, tmp_path)
    assert numbers["calibration"] == "calibration.yaml"
    assert numbers["transfer"]["kind"] == "schlick" and numbers["transfer"]["from"] == "calibration"
    assert "calibration made: out/calibration.yaml" in answer.stderr
    document = json.loads((tmp_path / "out" / "run.json").read_text())
    assert {"calibration.yaml", "calibration.png"} <= {file["name"] for file in document["files"]}
    made = (tmp_path / "out" / "calibration.yaml").stat()
    again = sonject("run", "scene.yaml", "-o", "out")
    assert again.returncode == 0 and "calibration made" not in again.stderr
    assert (tmp_path / "out" / "calibration.yaml").stat().st_mtime_ns == made.st_mtime_ns
    # a scene that names the file gives the same image
    by_name = sonject("run", "scene.yaml", "-o", "named", "--set",
                      "input.calibration=out/calibration.yaml")
    assert by_name.returncode == 0, by_name.stderr
    assert (tmp_path / "named" / "image.png").read_bytes() == (tmp_path / "out" / "image.png").read_bytes()


def test_shards_share_it_and_other_images_have_their_own(sonject, tmp_path):
    scene(tmp_path, calibration="auto")
    for shard in ("1/2", "2/2"):
        answer = sonject("run", "scene.yaml", "-o", "shards", "--shard", shard)
        assert answer.returncode == 0, answer.stderr
        assert ("calibration made" in answer.stderr) == (shard == "1/2")
    assert sonject("merge", "shards").returncode == 0
    run_document(sonject, tmp_path)
    for name in ("image.png", "calibration.yaml", "calibration.png", "truth.json"):
        assert (tmp_path / "shards" / name).read_bytes() == (tmp_path / "out" / name).read_bytes()
    old = (tmp_path / "out" / "calibration.yaml").read_text()
    (tmp_path / "swath.png").write_bytes(png_bytes(Made("decibel", bits=8).numbers))
    assert sonject("run", "scene.yaml", "-o", "out").returncode == 2
    assert (tmp_path / "out" / "calibration.yaml").read_text() == old
    numbers, _ = run_document(sonject, tmp_path, "--overwrite")
    assert numbers["transfer"]["kind"] == "decibel"


def test_one_of_another_scene_or_that_was_changed_is_made_anew(sonject, tmp_path):
    scene(tmp_path, calibration="auto")
    run_document(sonject, tmp_path)
    made = (tmp_path / "out" / "calibration.yaml").read_text()
    assert made.count("made_for: ") == 1
    for folder, kept, geometry, is_same in (
            ("kept", made, GEOMETRY, True),
            ("changed", made.replace("kind: schlick", "kind: gamma"), GEOMETRY, True),
            ("other", made, GEOMETRY.replace("5 cm", "6 cm", 1), False)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "calibration.yaml").write_text(kept)
        (tmp_path / folder / "calibration.png").write_bytes((tmp_path / "out/calibration.png").read_bytes())
        answer = sonject("run", "scene.yaml", "-o", folder, "--set", f"input.geometry={geometry}")
        assert answer.returncode == 0, answer.stderr
        assert ("calibration made" in answer.stderr) == (folder != "kept")
        assert ((tmp_path / folder / "calibration.yaml").read_text() == made) == is_same


def test_campaigns_make_one_for_each_swath(sonject, tmp_path):
    scene(tmp_path, calibration="auto")
    (tmp_path / "other.png").write_bytes(png_bytes(Made("decibel", bits=8).numbers))
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN)
    (tmp_path / "scene.yaml").write_text(
        (SCENE % ("auto", "altitude: 10 m")).split("patch:")[0])
    for folder, arguments in (("whole", [()]), ("parts", [("--shard", "1/2"), ("--shard", "2/2")])):
        for argument in arguments:
            answer = sonject("campaign", "campaign.yaml", "-o", folder, *argument)
            assert answer.returncode == 0, answer.stderr
    assert sonject("merge", "parts").returncode == 0
    assert contents(tmp_path / "whole") == contents(tmp_path / "parts")
    kinds = {json.loads(path.read_text())["numbers"]["transfer"]["kind"]
             for path in (tmp_path / "whole").glob("*/truth/*.json")}
    assert kinds == {"schlick", "decibel"}
    assert page_data(tmp_path / "whole")["numbers"]["transfer"] == {
        "scene": 0, "calibration": 4, "patch": 0, "default": 0, "fallback": 0, "file": 0}
    assert {path.name for path in (tmp_path / "whole" / "calibrations").iterdir()} == {
        "0.yaml", "0.png", "1.yaml", "1.png"}
    # Going on restores the numbers of the existing images. Another campaign removes the calibrations.
    calibration = tmp_path / "whole" / "calibrations" / "0.yaml"
    calibration.write_text(calibration.read_text().replace("noise_floor: -", "noise_floor: -1"))
    gone = list((tmp_path / "whole").glob("*/records/*.json"))
    assert gone
    for record in gone:
        record.unlink()
    assert sonject("campaign", "campaign.yaml", "-o", "whole").returncode == 0
    assert contents(tmp_path / "whole") == contents(tmp_path / "parts")
    (tmp_path / "scene.yaml").write_text(
        (SCENE % ("swath.yaml", "altitude: 10 m")).split("patch:")[0])
    assert sonject("campaign", "campaign.yaml", "-o", "whole", "--overwrite").returncode == 0
    assert not (tmp_path / "whole" / "calibrations").exists()


def test_all_images_of_a_swath_share_one_where_pings_differ(sonject, tmp_path):
    scene(tmp_path, calibration="auto")
    rows = len(Made("schlick", bits=8).numbers)
    (tmp_path / "pings.csv").write_text(f"row,altitude_m,first_slant_range_m\n0,10,30\n{rows - 1},10,30.5\n")
    (tmp_path / "scene.yaml").write_text((SCENE % ("auto", "altitude: from_file")).split("patch:")[0].replace(
        "first_slant_range: 30 m}", "first_slant_range: from_file}\n  pings: pings.csv"))
    (tmp_path / "campaign.yaml").write_text(
        CAMPAIGN.replace(", {path: other.png}", "").replace("{train: 0.5, val: 0.5}", "{all: 1}"))
    told = [sonject.done("campaign", "campaign.yaml", "-o", "parts", "--shard", shard).stderr
            for shard in ("2/2", "1/2")]
    assert ["calibration made" in text for text in told] == [True, False]
    sonject.done("merge", "parts")
    sonject.done("campaign", "campaign.yaml", "-o", "whole")
    assert contents(tmp_path / "whole") == contents(tmp_path / "parts")


def test_a_kill_leaves_no_part_of_it(tmp_path):
    scene(tmp_path, calibration="auto")
    for delay in (0.2, 0.5, 0.8, 1.2):
        process = subprocess.Popen([COMMAND, "run", "scene.yaml", "-o", "out"], cwd=tmp_path,
                                   stderr=subprocess.DEVNULL)
        time.sleep(delay)
        process.send_signal(signal.SIGKILL)
        process.wait()
        if (tmp_path / "out" / "calibration.yaml").exists():
            assert (tmp_path / "out" / "calibration.yaml").read_text().splitlines()[-1].startswith(
                "  made_for: ")
    subprocess.run([COMMAND, "run", "scene.yaml", "-o", "out"], cwd=tmp_path, check=True,
                   capture_output=True)
    assert not [name for name in os.listdir(tmp_path / "out") if ".part" in name]
