"""Tests of everyday sidescan: images whose geometry changes from row to row, two sides in one image, and
the water column."""

import csv
import json
import xml.etree.ElementTree

import numpy
import pytest

import images
from conftest import assert_refused, write_text
from measured_images import measured, read_png, read_xtf

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
    """Writes line.tif, which does not tell its geometry, and returns its amplitudes."""
    pixels = numpy.random.default_rng(7).rayleigh(2000.0, (ROWS, COLUMNS)).astype(numpy.uint16)
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(pixels))
    return pixels


def test_altitudes_come_from_a_table_of_pings(sonject, tmp_path, line):
    """The patch's mean counts. Altitudes are linear between the table's rows: 6 m at row 0, 9 m from row 20 on."""
    (tmp_path / "pings.csv").write_text("row, altitude_m\n0, 6.0\n20, 9.0\n59, 9.0\n")
    heights = numpy.interp(numpy.arange(10, 50), [0, 20, 59], [6, 9, 9])
    assert f"altitude {heights.mean():.3g} m" in sonject.done("check", write_scene(tmp_path)).stdout
    sonject.done("run", tmp_path / "scene.yaml", "-o", "a")
    sonject.done("run", write_scene(tmp_path, altitude=f"{heights.mean():.17g} m"), "-o", "b")
    truths = [json.loads((tmp_path / name / "truth.json").read_text())["objects"][0] for name in "ab"]
    assert truths[0]["ground_range_m"] == pytest.approx(truths[1]["ground_range_m"], rel=1e-12)
    assert truths[0]["box"] == truths[1]["box"]


def test_altitudes_of_a_table_are_those_at_the_objects(sonject, tmp_path, line):
    """Without a patch, the altitudes at the objects count. A note tells if they differ."""
    (tmp_path / "pings.csv").write_text("row, altitude_m\n0, 6.0\n20, 9.0\n59, 9.0\n")
    scene = write_scene(tmp_path)
    scene.write_text(scene.read_text().replace(f"patch: {PATCH}\n", ""))
    text = sonject.done("check", scene, "--set", "objects[0].position={row: 10, column: 150}").stdout
    assert "altitude 7.5 m" in text and "note: the altitude" not in text
    two = "objects=[{shape: sphere, diameter: 0.4 m, position: {row: 5, column: 150}}, " \
          "{shape: sphere, diameter: 0.4 m, position: {row: 25, column: 150}}]"
    assert "note: the altitude varies from 6.75 to 9.00 m" in sonject.done("check", scene, "--set", two).stdout


def test_first_slant_ranges_come_from_a_table_of_pings(sonject, tmp_path, line):
    """The mean over the patch counts, if all ranges are within a column of it."""
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


def target_of(folder, record):
    """Returns the truth of an image's target."""
    return json.loads((folder / "all" / "truth" / f"{record['id']:08}.json").read_text())["objects"][0]


def test_grey_images_are_the_line_as_it_is_converted(sonject, tmp_path, line):
    """Grey images equal the converted line except where a target changes them. fit refuses their levels."""
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,6\n59,6\n")
    text = CAMPAIGN + "grey: [-50 dB, -20 dB]\noutputs: [influence]\n"
    sonject.done("campaign", write_campaign(tmp_path, text), "-o", "data", "--quiet")
    sonject.done("convert", "line.tif", "grey.png", "--db", "-50:-20")
    grey = read_png(tmp_path / "grey.png")
    share = (20 * numpy.log10(numpy.maximum(line, 1e-9) / 65535) + 50) / 30
    assert numpy.array_equal(grey, numpy.floor(255 * share.clip(0, 1) + 0.5)) and 0 < numpy.median(grey) < 255
    changed = 0
    for record in records(tmp_path / "data"):
        place = record["swath"]
        of_line = grey[place["row"]:place["row"] + 16, place["column"]:place["column"] + 60]
        image, influence = (read_png(tmp_path / "data" / "all" / kind / f"{record['id']:08}.png") for kind in ("images", "influence"))
        assert numpy.array_equal(image[influence == 0], of_line[influence == 0])
        changed += (image != of_line).sum()
    assert changed > 12 * 20
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN + "grey: [-90 dB, -60 dB]\n")
    told = sonject.done("campaign", "campaign.yaml", "-o", "white").stderr
    assert told.count("of the pixels are white at grey levels of -90 to -60 dB") == 1
    (tmp_path / "campaign.yaml").write_text(text)
    (tmp_path / "contacts.csv").write_text("image,row,column,rows,columns\n" + "data/all/images/00000000.png,4,9,5,20\n" * 12)
    assert_refused(sonject("fit", "campaign.yaml", "contacts.csv", "-o", "fitted.yaml"), 3, "00000000.png: was made with grey: [-50 dB, -20 dB]")
    for more, words in ("grey: [-20 dB, -50 dB]", "black must be below white"), ("grey: -50 dB", "must be two levels"), (
            "grey: [-50 dB, -20 dB]\nformat: as_input", "grey: cannot be combined with format: as_input"):
        (tmp_path / "campaign.yaml").write_text(CAMPAIGN + more)
        assert_refused(sonject("campaign", "campaign.yaml", "-o", "none"), 3, words)


def test_campaigns_know_the_highest_ping(sonject, tmp_path, line):
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,5\n30,9\n59,7\n")
    sonject.done("campaign", write_campaign(tmp_path), "-o", "data")
    for record in records(tmp_path / "data"):
        assert 0.15 * (record["swath"]["column"] + 0.5) > 9.0
        rows = record["swath"]["row"] + numpy.arange(16)
        truth = target_of(tmp_path / "data", record)
        altitude = numpy.interp(rows, [0, 30, 59], [5, 9, 7]).mean()
        assert truth["ground_range_m"]**2 + (altitude - truth["height_m"])**2 == pytest.approx(
            truth["slant_range_m"]**2, rel=1e-6)


@pytest.mark.parametrize("more, words", [
    ("medium: {layers: [{bottom: 0 m, sound_speed: 1500 m/s}, {bottom: 3 m, sound_speed: 1520 m/s}]}",
     "begins at 1.575 m slant range, in the water column, which is not possible where layers bend the sound: begin "
     "the patch at column "),
    ("seabed: {relief: [mound: {position: {row: 30, column: 120}, height: 0.1 m, radius: 1 m}]}",
     "in the water column, which is not possible over a seabed with relief: begin the patch at column 40, behind the bottom's "
     "first return at 6.000 m"),
])
def test_what_may_not_begin_in_the_water_column_says_why(sonject, tmp_path, line, more, words):
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,6\n59,6\n")
    patch = "{row: 10, column: 10, rows: 40, columns: 170}"
    answer = sonject("check", write_scene(tmp_path, patch=patch, more=more))
    assert_refused(answer, 3, "scene.yaml:2:", words)
    column = int(answer.stderr.split("begin the patch at column ")[1].split(",")[0])
    patch = patch.replace("column: 10", f"column: {column}").replace("columns: 170", "columns: 140")
    sonject.done("check", write_scene(tmp_path, patch=patch, more=more))


# ---- Two sides in one image.

NADIR = 203.5  # between columns 203 and 204
TWO_SIDED = """\
sonject: 1
input: {{path: {path}, geometry: {{row_spacing: 0.1 m, column_spacing: 0.15 m, {geometry}, side: {side}}}}}
patch: {{row: 10, column: {column}, rows: 40, columns: 120}}
sonar: {{frequency: 600 kHz, bandwidth: 10 kHz, altitude: 6 m, resolution: 0.1 m}}
objects:
  - {{name: can, shape: cylinder, length: 1 m, diameter: 0.4 m, heading: 30 deg, roll: 10 deg,
     position: {{row: 28, column: {at}}}}}
  - {{name: box, shape: box, length: 1 m, width: 0.5 m, height: 0.3 m, position: {{along_track: 2.2 m, slant_range: 22 m}}}}
"""


@pytest.fixture
def waterfall(tmp_path):
    """Writes port and starboard from the nadir outwards, and both in one image, port mirrored at its left."""
    random = numpy.random.default_rng(11)
    sides = [random.rayleigh(2000.0, (ROWS, columns)).astype(numpy.uint16) for columns in (204, 196)]
    (tmp_path / "both.tif").write_bytes(images.tiff_bytes(numpy.hstack([sides[0][:, ::-1], sides[1]])))
    for name, pixels in zip(("port", "starboard"), sides):
        (tmp_path / f"{name}.tif").write_bytes(images.tiff_bytes(pixels))
    return sides


def write_both(folder, geometry, more="", name="scene.yaml", altitude="6 m", pings=""):
    """Writes a scene of the image of both sides, without objects."""
    (folder / name).write_text(f"""\
sonject: 1
input: {{path: both.tif, geometry: {{row_spacing: 0.1 m, column_spacing: 0.15 m, {geometry}}}, {pings}}}
sonar: {{frequency: 600 kHz, bandwidth: 10 kHz, altitude: {altitude}, resolution: 0.1 m}}
{more}
""")


def run_sides(sonject, folder, side):
    """Makes the same injection into the image of one side and into that of two. Returns the folders."""
    one, both = folder / "one.yaml", folder / "both.yaml"
    one.write_text(TWO_SIDED.format(path=f"{side}.tif", geometry="first_slant_range: 0.075 m", side=side, column=60,
                                    at=100))
    column, at = (204 - 180, 203 - 100) if side == "port" else (204 + 60, 204 + 100)
    both.write_text(TWO_SIDED.format(path="both.tif", geometry=f"nadir_column: {NADIR}", side=side, column=column,
                                     at=at))
    sonject.done("run", one, "-o", "one", "--labels", "yolo,voc")
    sonject.done("run", both, "-o", "both", "--labels", "yolo,voc")
    return folder / "one", folder / "both"


def mirrored(side, column, columns=1):
    """Returns the first of a side's columns as a column of the image of both sides."""
    return 204 - column - columns if side == "port" else 204 + column


@pytest.mark.parametrize("side", ["port", "starboard"])
def test_a_side_of_two_is_as_one_by_itself(sonject, tmp_path, waterfall, side):
    """Pixels and masks agree to the last bit. Boxes and labels are in the image's own pixels."""
    one, both = run_sides(sonject, tmp_path, side)
    before = images.read_tiff(tmp_path / "both.tif")
    turn = slice(None, None, -1) if side == "port" else slice(None)

    def half(pixels):
        return (pixels[:, :204] if side == "port" else pixels[:, 204:])[:, turn]

    after, alone = images.read_tiff(both / "image.tif"), images.read_tiff(one / "image.tif")
    assert numpy.array_equal(half(after), alone) and (after != before).sum() > 100
    other = slice(204, None) if side == "port" else slice(0, 204)
    assert numpy.array_equal(after[:, other], before[:, other])
    for name in ("highlight", "shadow", "labels", "influence"):
        masks = [read_png(folder / f"{name}.png") for folder in (one, both)]
        assert numpy.array_equal(half(masks[1]), masks[0]) and masks[0].any() and not masks[1][:, other].any()
    for name in ("energy", "patch"):
        layers = [images.read_tiff(folder / f"{name}.tif") for folder in (one, both)]
        assert numpy.array_equal(layers[1][:, turn], layers[0])
    truths = [json.loads((folder / "truth.json").read_text()) for folder in (one, both)]
    for found, expected in zip(truths[1]["objects"], truths[0]["objects"], strict=True):
        assert found["column"] == pytest.approx(mirrored(side, expected["column"]), abs=1e-6)
        for key in ("row", "along_track_m", "slant_range_m", "ground_range_m", "highlight_cut", "shadow_visible",
                    "target_strength_db", "highlight_contrast_db", "shadow_visibility_db", "position"):
            assert found[key] == expected[key]
        for box in ("highlight", "shadow", "box"):
            assert found[box]["column"] == mirrored(side, expected[box]["column"], expected[box]["columns"])
            for key in ("row", "rows", "columns"):
                assert found[box][key] == expected[box][key]
            for key in ("slant_range_m", "width_m", "ground_range_m", "along_track_m"):
                assert found[box][key] == pytest.approx(expected[box][key], rel=1e-9)
    found, expected = (json.loads((folder / "coco.json").read_text())["annotations"] for folder in (both, one))
    for a, b in zip(found, expected, strict=True):
        x, y, width, height = b["bbox"]
        assert a["bbox"] == [mirrored(side, x, width), y, width, height] and a["area"] == b["area"]
    found, expected = (list(csv.DictReader((folder / "contacts.csv").open())) for folder in (both, one))
    for a, b in zip(found, expected, strict=True):
        assert float(a["column"]) == pytest.approx(mirrored(side, float(b["column"])), abs=1e-6)
        assert int(a["box_column"]) == mirrored(side, int(b["box_column"]), int(b["box_columns"]))
    found, expected = (list(xml.etree.ElementTree.parse(folder / "image.xml").iter("bndbox")) for folder in (both, one))
    for a, b in zip(found, expected, strict=True):
        first, last = (int(b.find(name).text) for name in ("xmin", "xmax"))
        assert int(a.find("xmin").text) == 1 + mirrored(side, first - 1, last - first + 1)
        assert int(a.find("xmax").text) == int(a.find("xmin").text) + last - first
    for a, b in zip((both / "image.txt").read_text().splitlines(), (one / "image.txt").read_text().splitlines(),
                    strict=True):
        a, b = (numpy.array(line.split(), float) for line in (a, b))
        middle = mirrored(side, b[1] * waterfall[side == "starboard"].shape[1], 0)
        assert a[1] * 400 == pytest.approx(middle, abs=1e-3) and a[2] == pytest.approx(b[2])


def test_images_of_a_port_half_say_where_they_lie(sonject, tmp_path, waterfall):
    """energy.tif, whose range grows to the left, is read as such."""
    _, both = run_sides(sonject, tmp_path, "port")
    told = (both / "energy.tif").read_bytes()
    for note in (b"sonject:nadir_column=119\n", b"sonject:first_slant_range_m=9.075\n", b"sonject:side=port\n"):
        assert note in told
    (tmp_path / "taken.yaml").write_text("""\
sonject: 1
input: {path: both/energy.tif, geometry: from_file, transfer: {kind: intensity}}
sonar: {frequency: 600 kHz, bandwidth: 10 kHz, altitude: from_file, resolution: 0.1 m}
patch: {row: 0, column: 0, rows: 40, columns: 100}
""")
    last = 9.075 + 119 * 0.15
    assert f"slant range {last - 99 * 0.15:.2f}...{last:.2f} m, port" in sonject.done("check", "taken.yaml").stdout
    sonject.done("quicklook", "both/energy.tif", "-o", "a.png", "--transfer", "intensity")
    assert_refused(sonject("quicklook", "both/energy.tif", "-o", "b.png", "--range-axis", "ground"), 3,
                   "has columns to the left of its nadir")
    # 204 columns of port, and 196 of starboard: ranges from -30.525 m on
    (tmp_path / "whole.png").write_bytes(images.png_bytes(numpy.ones((ROWS, 400)), b"""\
sonject:row_spacing_m=0.1
sonject:column_spacing_m=0.15
sonject:first_along_track_m=0
sonject:first_slant_range_m=0
sonject:nadir_column=203.5
sonject:altitude_m=6
sonject:side=starboard
sonject:range_axis=slant"""))
    sonject.done("quicklook", "whole.png", "-o", "a.png")
    assert_refused(sonject("quicklook", "whole.png", "-o", "b.png", "--range-axis", "ground"), 3,
                   "has columns to the left of its nadir")
    assert_refused(sonject("convert", "both/energy.tif", "b.tif", "--range-axis", "ground"), 3,
                   "has columns to the left of its nadir")
    sonject.done("convert", "both/energy.tif", "b.tif", "--row-spacing", 0.1, "--column-spacing", 0.15,
                 "--first-range", 9.075)
    assert b"nadir_column" not in (tmp_path / "b.tif").read_bytes()


@pytest.mark.parametrize("geometry, patch, words", [
    ("nadir_column: 0", "", "input.geometry.nadir_column: must be above 0, not 0"),
    ("nadir_column: 400, side: port", "",
     "input.geometry.nadir_column: nadir_column 400 does not lie among the image's 400 columns with some to port: if all"),
    ("nadir_column: 399.5, side: starboard", "",
     "input.geometry.nadir_column: nadir_column 399.5 does not lie among the image's 400 columns with some to starboard"),
    ("nadir_column: 203.5, side: port", "{row: 0, column: 100, rows: 60, columns: 120}",
     "the patch's columns 100 to 219 are not all to port of nadir_column 203.5: choose others, or the other side"),
    ("nadir_column: 203.5, side: starboard", "{row: 0, column: 203, rows: 60, columns: 120}",
     "the patch's columns 203 to 322 are not all to starboard of nadir_column 203.5"),
    ("nadir_column: 203.5, side: port", "{row: 0, column: 180, rows: 60, columns: 20}",
     "all of the patch, up to 3.525 m slant range, lies in the water column, before the bottom's first return at 6.000"),
    ("side: port", "", "input.geometry.first_slant_range: missing; add it"),
])
def test_wrong_nadir_columns_are_refused(sonject, tmp_path, waterfall, geometry, patch, words):
    write_both(tmp_path, geometry, patch and f"patch: {patch}")
    assert_refused(sonject("check", "scene.yaml"), 3, "scene.yaml:2:", words)


def test_without_a_patch_the_side_is_worked_on(sonject, tmp_path, waterfall):
    for side, words in (("port", "60 x 204 pixels from row 0, column 0\n"),
                        ("starboard", "60 x 196 pixels from row 0, column 204\n")):
        write_both(tmp_path, f"nadir_column: 203.5, side: {side}")
        assert words in sonject.done("check", "scene.yaml").stdout


@pytest.mark.parametrize("side", ["port", "starboard"])
def test_campaigns_cut_images_out_of_a_side(sonject, tmp_path, waterfall, side):
    """Images are cut as they lie in the side, away from contacts, which are in the image's own pixels."""
    write_both(tmp_path, f"nadir_column: 203.5, side: {side}", name="base.yaml")
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN.replace("columns: 60", "columns: 60, slant_range: [8 m, 14 m]"))
    sonject.done("campaign", "campaign.yaml", "-o", "data", "--set", "images=24", "--set", "targets[0].object.diameter=0.5 m",
                 "--set", "swaths=[{path: both.tif, avoid: [{row: 20, column: 120, rows: 5, columns: 10}]}]")
    pixels = images.read_tiff(tmp_path / "both.tif")
    columns = [record["swath"]["column"] for record in records(tmp_path / "data")]
    assert max(columns) - min(columns) > 10
    for record in records(tmp_path / "data"):
        row, column = record["swath"]["row"], record["swath"]["column"]
        middle = abs(column + 29.5 - NADIR) * 0.15
        assert 8 <= middle <= 14 and (column + 59 < NADIR) == (side == "port")
        nearest = min(abs(column - NADIR), abs(column + 59 - NADIR)) * 0.15
        assert nearest > 6 and not (row < 25 and row + 16 > 20 and column < 130 and column + 60 > 120)
        image = images.read_tiff(tmp_path / "data/all/images" / f"{record['id']:08}.tif")
        cut = pixels[row:row + 16, column:column + 60]
        truth = target_of(tmp_path / "data", record)
        changed = numpy.argwhere(image != cut)
        assert (image == cut).mean() > 0.5 and abs(numpy.median(changed[:, 0]) - truth["row"]) < 4
        # the shadow lies behind the target, away from the nadir
        shadow, middle = truth["shadow"], truth["column"]
        assert (shadow["column"] + 0.5 * shadow["columns"] < middle) == (side == "port")
        assert truth["slant_range_m"] == pytest.approx(abs(column + truth["column"] - NADIR) * 0.15, abs=0.3)


@pytest.mark.parametrize("side", ["port", "starboard"])
def test_images_are_limited_in_range_over_altitude(sonject, tmp_path, waterfall, side):
    """The limits hold at any altitude. Images may begin in the water column, and targets lie up to its edge."""
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,4\n30,7\n59,5\n")
    write_both(tmp_path, f"nadir_column: 203.5, side: {side}", name="base.yaml", altitude="from_file", pings="pings: pings.csv")
    campaign = CAMPAIGN.replace("images: 12", "images: 40").replace("line.tif", "both.tif").replace(
        "columns: 60", "columns: 60, spread: 0.9, range_over_altitude: [1.1, 1.8]")
    (tmp_path / "campaign.yaml").write_text(campaign)
    sonject.done("campaign", "campaign.yaml", "-o", "data")
    ratios, begins, grounds = [], [], []
    for record in records(tmp_path / "data"):
        rows = record["swath"]["row"] + numpy.arange(16)
        altitude = numpy.interp(rows, [0, 30, 59], [4, 7, 5]).mean()
        columns = numpy.abs(record["swath"]["column"] + numpy.array([0, 29.5, 59]) - NADIR) * 0.15
        ratios.append(columns[1] / altitude)
        begins.append(columns.min() / altitude)
        truth = target_of(tmp_path / "data", record)
        grounds.append(truth["ground_range_m"] / altitude)
    assert 1.1 <= min(ratios) < 1.25 and 1.6 < max(ratios) <= 1.8
    assert numpy.mean(numpy.array(begins) < 1) > 0.9 and min(grounds) < 0.35
    for chip, words in (("[100, 200]", "both.tif has no place for images of 16 x 60 pixels, at 100 to 200 times the "
                         "sonar's altitude, 4 to 7 m"),
                        ("[0.5, 2]", "chip.range_over_altitude: must be two rising numbers within 1...1000"),
                        ("[3, 2]", "chip.range_over_altitude: must be two rising numbers within 1...1000"),
                        ("3", "chip.range_over_altitude: must be two numbers, [least, most]")):
        (tmp_path / "campaign.yaml").write_text(campaign.replace("[1.1, 1.8]", chip))
        assert_refused(sonject("campaign", "campaign.yaml", "-o", "none"), 3, words)


def test_objects_of_whole_swaths_are_limited_in_range_over_altitude(sonject, tmp_path, line):
    """The altitudes of the image's rows count, not those of others. No image has rows without such ranges."""
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,4\n40,7\n41,40\n59,40\n")
    text = CAMPAIGN.replace("columns: 60", "columns: all, spread: 1, range_over_altitude: [1.5, 2.5]")
    sonject.done("campaign", write_campaign(tmp_path, text.replace("images: 12", "images: 24")), "-o", "data")
    ranges = []
    for record in records(tmp_path / "data"):
        truth = target_of(tmp_path / "data", record)
        first, last = 4 + 3 / 40 * (record["swath"]["row"] + numpy.array([0, 15]))
        assert last < 7.01
        # the object's column is that of its middle, and its highlight is nearer
        assert 1.5 * last - 0.5 <= truth["slant_range_m"] <= 2.5 * first + 0.5
        ranges.append(truth["slant_range_m"])
    assert min(ranges) < 9 and max(ranges) > 12
    answer = sonject("campaign", "campaign.yaml", "-o", "none", "--set", "chip.range_over_altitude=[10, 11]")
    assert_refused(answer, 3, "line.tif has no place for objects in images of 16 x 200 pixels, at 10 to 11 times")


def test_targets_in_layered_water_stay_behind_the_water_column(sonject, tmp_path, line):
    (tmp_path / "pings.csv").write_text("row,altitude_m\n0,6\n59,6\n")
    text = CAMPAIGN.replace("columns: 60", "columns: 60, range_over_altitude: [1.1, 2]")
    layers = "medium: {layers: [{bottom: 0 m, sound_speed: 1500 m/s}, {bottom: 3 m, sound_speed: 1505 m/s}]}"
    sonject.done("campaign", write_campaign(tmp_path, text, more=layers), "-o", "data")
    assert all(0.15 * (record["swath"]["column"] + 0.5) > 6 for record in records(tmp_path / "data"))


def test_contacts_of_a_port_half_are_measured_as_others(sonject, tmp_path, waterfall):
    """Contacts are measured by truth and by boxes. Boxes are in the image's own pixels."""
    for folder in run_sides(sonject, tmp_path, "port"):
        (tmp_path / f"{folder.name}.json").write_bytes((folder / "truth.json").read_bytes())
    one = json.loads((tmp_path / "one.json").read_text())["objects"]
    # the half alone, since the other half would count as seabed, too
    pixels = images.read_tiff(tmp_path / "both" / "image.tif")[:, :204]
    (tmp_path / "half.tif").write_bytes(images.tiff_bytes(numpy.ascontiguousarray(pixels)))
    (tmp_path / "turned.tif").write_bytes(images.tiff_bytes(numpy.ascontiguousarray(pixels[:, ::-1])))
    box = one[0]["box"]

    def corners(column):
        return f"{box['row'] - 8},{column - 12},{box['rows'] + 16},{box['columns'] + 24}"

    ways = [(["--truth", "both.json"], ["--truth", "one.json"]),
            (["--range-to-left", "--box", corners(mirrored("port", box["column"], box["columns"]))],
             ["--box", corners(box["column"])])]
    for left, right in ways:
        found, expected = (json.loads(sonject.done("measure", image, *options).stdout)["contacts"]
                           for image, options in (("half.tif", left), ("turned.tif", right)))
        assert len(found) == len(expected) > 0
        for a, b in zip(found, expected):
            for key, value in b.items():
                if key.endswith("_box") and value:
                    value = {**value, "column": mirrored("port", value["column"], value["columns"])}
                assert a[key] == value or key == "image"
        assert any(contact["shadow_box"] for contact in expected)
    answer = sonject("measure", "half.tif", "--range-to-left")
    assert answer.returncode == 2 and "--range-to-left is for --box and --truth" in answer.stderr
    assert_refused(sonject("measure", "half.tif", "--range-to-left", "--box", "0,200,5,9"), 3, "is not inside the image")


def test_a_measured_line_of_two_sides_is_as_its_recording(sonject, tmp_path):
    """Compares the Iver2's recording with an image of both its sides, with the altitudes in a table."""
    line = measured("sidescan/scotsman-iver2.xtf")
    (tmp_path / "line.xtf").write_bytes(line.read_bytes())
    sides = []
    for channel in ("port", "starboard"):
        sonject.done("convert", "line.xtf", f"{channel}.npy", "--channel", channel)
        sides.append(numpy.load(tmp_path / f"{channel}.npy"))
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(numpy.hstack([sides[0][:, ::-1], sides[1]])))
    _, altitudes = read_xtf(line)
    (tmp_path / "pings.csv").write_text("row,altitude_m\n" + "".join(
        f"{row},{altitude!r}\n" for row, altitude in enumerate(altitudes.tolist()) if altitude > 0 or row == 0)
        .replace("0,0.0\n", f"0,{altitudes[1].item()!r}\n", 1))
    text = """\
sonject: 1
input: {{path: {}, {} geometry: {{row_spacing: 15 cm, column_spacing: 2.9277 cm, {}, side: {}}}}}
patch: {{row: 20, column: {}, rows: 120, columns: 600}}
sonar: {{frequency: 600 kHz, bandwidth: 25 kHz, altitude: from_file}}
objects: [{{name: can, shape: cylinder, length: 1 m, diameter: 0.4 m, heading: 30 deg, burial: 0 m}}]
"""
    for number, side in enumerate(("port", "starboard")):
        (tmp_path / "xtf.yaml").write_text(text.format("line.xtf", f"channel: {side},", "first_slant_range: 0.014639 m",
                                                       side, 240))
        (tmp_path / "tif.yaml").write_text(text.format("line.tif", "pings: pings.csv,",
                                                       "nadir_column: 1023.5, first_slant_range: 0.0000005 m", side,
                                                       1024 - 840 if side == "port" else 1024 + 240))
        for kind in ("xtf", "tif"):
            sonject.done("run", f"{kind}.yaml", "-o", f"{kind}-{side}")
        sonject.done("convert", f"xtf-{side}/image.xtf", "after.npy", "--channel", side)
        expected, found = numpy.load(tmp_path / "after.npy"), images.read_tiff(tmp_path / f"tif-{side}" / "image.tif")
        half = found[:, 1023::-1] if side == "port" else found[:, 1024:]
        changed = expected != sides[number]
        assert changed.sum() > 300
        # the numbers of first slant range differ by roundings alone
        assert (half != expected).sum() < 0.002 * changed.sum()


@pytest.mark.parametrize("side", ["port", "starboard"])
def test_check_tells_the_images_rows(sonject, tmp_path, side):
    write_text(tmp_path, "synthetic: {rows: 100, columns: 128}",
               f"row_spacing: 5 cm, side: {side}, column_spacing: 5 cm, first_slant_range: 20 m",
               "{shape: sphere, diameter: 40 cm, position: {row: 20, column: 60}}", "5 m")
    assert "(sphere): row 20.0, slant range" in sonject.done("check", "scene.yaml").stdout
