"""Sidescan as it comes: images whose geometry changes from row to row, two sides in one, and what lies
under the sonar."""

import json

import numpy
import pytest

import images
from conftest import assert_refused

ROWS, COLUMNS = 60, 200
GEOMETRY = "{row_spacing: 0.1 m, column_spacing: 0.15 m, first_slant_range: 0.075 m}"
SCENE = """\
sonject: 1
input: {{path: line.tif, pings: pings.csv, geometry: {geometry}}}
patch: {patch}
sonar: {{frequency: 600 kHz, bandwidth: 10 kHz, altitude: {altitude}, resolution: 0.1 m}}
{more}
objects: [{{name: can, shape: cylinder, length: 1 m, diameter: 0.4 m, heading: 30 deg}}]
"""
PATCH = "{row: 10, column: 60, rows: 40, columns: 120}"


def write_scene(folder, geometry=GEOMETRY, altitude="from_file", patch=PATCH, more=""):
    scene = folder / "scene.yaml"
    scene.write_text(SCENE.format(geometry=geometry, altitude=altitude, patch=patch, more=more))
    return scene


@pytest.fixture
def line(tmp_path):
    """Amplitudes of line.tif, whose file says nothing of its geometry."""
    pixels = numpy.random.default_rng(7).rayleigh(2000.0, (ROWS, COLUMNS)).astype(numpy.uint16)
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(pixels))
    return pixels


def test_altitudes_come_from_a_table_of_pings(sonject, tmp_path, line):
    """Linear between the table's rows; the patch's mean, of 6 m at row 0 to 9 m at row 20 and on."""
    (tmp_path / "pings.csv").write_text("row, altitude_m\n0, 6.0\n20, 9.0\n59, 9.0\n")
    heights = numpy.interp(numpy.arange(10, 50), [0, 20, 59], [6, 9, 9])
    assert f"altitude {heights.mean():.3g} m" in sonject.done("check", write_scene(tmp_path)).stdout
    sonject.done("run", tmp_path / "scene.yaml", "-o", "a")
    sonject.done("run", write_scene(tmp_path, altitude=f"{heights.mean():.17g} m"), "-o", "b")
    truths = [json.loads((tmp_path / name / "truth.json").read_text())["objects"][0] for name in "ab"]
    assert truths[0]["ground_range_m"] == pytest.approx(truths[1]["ground_range_m"], rel=1e-12)
    assert truths[0]["box"] == truths[1]["box"]


def test_first_slant_ranges_come_from_a_table_of_pings(sonject, tmp_path, line):
    """Their mean over the patch, where they stay within a column."""
    geometry = GEOMETRY.replace("0.075 m", "from_file")
    (tmp_path / "pings.csv").write_text("row altitude_m first_slant_range_m\n0 6 5.0\n59 6 5.295\n")
    first = 5.0 + 0.295 * 29.5 / 59 + 60 * 0.15
    answer = sonject.done("check", write_scene(tmp_path, geometry))
    assert f"slant range {first:.2f}...{first + 119 * 0.15:.2f} m" in answer.stdout
    (tmp_path / "pings.csv").write_text("row altitude_m first_slant_range_m\n0 6 5.0\n59 6 5.5\n")
    assert_refused(sonject("check", write_scene(tmp_path, geometry)), 3,
                   "input.pings: first_slant_range_m is from 5.085 to 5.415 m over the patch's rows, more than a "
                   "column of 0.15 m from its mean: choose fewer rows")


PINGS = {
    "too many": ("row,altitude_m\n0,6\n60,6\n",
                 "input.pings: has rows from 0 to 60, the image those from 0 to 59: correct the table's rows"),
    "too few": ("row,altitude_m\n0,6\n48,6\n",
                "input.pings: has rows from 0 to 48, too few for the patch's, 10 to 49: add some, or choose another"),
    "late": ("row,altitude_m\n12,6\n59,6\n", "input.pings: has rows from 12 to 59, too few for the patch's"),
    "no altitude": ("row,altitude_m\n0,6\n5,0\n59,6\n",
                    "pings.csv:3: altitude_m: must be above 0; leave rows out that have none"),
    "no range": ("row,altitude_m,first_slant_range_m\n0,6,0\n5,6,-1\n",
                 "pings.csv:3: first_slant_range_m: must not be below 0"),
    "order": ("row,altitude_m\n3,6\n3,6\n", "pings.csv:3: row: must be above that of the sample before, 3, not 3"),
    "one": ("row,altitude_m\n3,6\n", "pings.csv:2: row: must have 2...1048576 samples, not 1"),
    "names": ("ping,altitude_m\n3,6\n", "this line must name the columns, among them row, and altitude_m"),
}


@pytest.mark.parametrize("case", PINGS)
def test_wrong_tables_of_pings_are_refused(sonject, tmp_path, line, case):
    text, words = PINGS[case]
    (tmp_path / "pings.csv").write_text(text)
    assert_refused(sonject("check", write_scene(tmp_path)), 3, words)


def test_a_table_that_lacks_what_is_taken_is_refused(sonject, tmp_path, line):
    geometry = GEOMETRY.replace("0.075 m", "from_file")
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,6\n59,6\n")
    assert_refused(sonject("check", write_scene(tmp_path, geometry)), 3,
                   "input.pings: has no column first_slant_range_m")
    scene = write_scene(tmp_path, geometry, altitude="6 m")
    scene.write_text(scene.read_text().replace(" pings: pings.csv,", ""))
    assert_refused(sonject("check", scene), 3, "input.geometry.first_slant_range: from_file needs input.pings")
    scene = write_scene(tmp_path)
    scene.write_text(scene.read_text().replace("path: line.tif", "uniform: {rows: 60, columns: 200}"))
    assert_refused(sonject("check", scene), 3, "input.pings: belongs to an image file (path), not to uniform")


CAMPAIGN = """\
sonject_campaign: 1
scene: base.yaml
images: 12
chip: {rows: 16, columns: 60}
swaths: [{path: line.tif}]
targets: [{class: ball, object: {shape: sphere, diameter: 0.4 m}}]
"""


def write_campaign(folder, campaign=CAMPAIGN, **options):
    text = write_scene(folder, **options).read_text()
    kept = [row for row in text.splitlines() if not row.startswith(("patch", "objects"))]
    (folder / "base.yaml").write_text("\n".join(kept) + "\n")
    (folder / "campaign.yaml").write_text(campaign)
    return "campaign.yaml"


def records(folder):
    return [json.loads(path.read_text()) for path in sorted((folder / "all" / "records").iterdir())]


def test_campaigns_know_the_highest_ping(sonject, tmp_path, line):
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,5\n30,9\n59,7\n")
    sonject.done("campaign", write_campaign(tmp_path), "-o", "data")
    for record in records(tmp_path / "data"):
        assert 0.15 * (record["swath"]["column"] + 0.5) > 9.0
        rows = record["swath"]["row"] + numpy.arange(16)
        truth = json.loads((tmp_path / "data/all/truth" / f"{record['id']:08}.json").read_text())["objects"][0]
        altitude = numpy.interp(rows, [0, 30, 59], [5, 9, 7]).mean()
        assert truth["ground_range_m"]**2 + (altitude - truth["height_m"])**2 == pytest.approx(
            truth["slant_range_m"]**2, rel=1e-6)


@pytest.mark.parametrize("more, words", [
    ("medium: {layers: [{bottom: 0 m, sound_speed: 1500 m/s}, {bottom: 3 m, sound_speed: 1520 m/s}]}",
     "begins at 1.575 m slant range, in the water column, which no patch may where layers bend the sound: begin with "
     "column "),
    ("seabed: {relief: [mound: {position: {row: 30, column: 120}, height: 0.1 m, radius: 1 m}]}",
     "in the water column, which no patch may over a seabed with relief: begin with column 40, behind the bottom's "
     "first return at 6.000 m"),
])
def test_what_may_not_begin_in_the_water_column_says_why(sonject, tmp_path, line, more, words):
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,6\n59,6\n")
    patch = "{row: 10, column: 10, rows: 40, columns: 170}"
    answer = sonject("check", write_scene(tmp_path, patch=patch, more=more))
    assert_refused(answer, 3, "scene.yaml:2:", words)
    column = int(answer.stderr.split("begin with column ")[1].split(",")[0])
    patch = patch.replace("column: 10", f"column: {column}").replace("columns: 170", "columns: 140")
    sonject.done("check", write_scene(tmp_path, patch=patch, more=more))
