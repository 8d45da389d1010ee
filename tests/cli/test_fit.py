"""Tests of sonject fit, which moves a campaign towards given contacts and reports its changes."""

import json
import re

import numpy
import pytest

from conftest import assert_refused, page_data
from made_swaths import COLUMNS, ROWS, Made
from test_init import init
import fitting
import images
import recordings


# Targets are so rough that they have no glints, whose rays would be nine tenths of all work. The nightly
# fit_closed_loop has glints.
ROUGH = ", material: {roughness: 5 mm}"


@pytest.fixture
def folder(sonject, tmp_path):
    fitting.make_seabeds(sonject)
    (tmp_path / "scene.yaml").write_text(fitting.SCENE)
    (tmp_path / "start.yaml").write_text(fitting.campaign(fitting.START, 40, 3, 64, 96, more=ROUGH))
    return tmp_path


def test_a_fit_comes_nearer_to_its_contacts(sonject, folder):
    (folder / "hidden.yaml").write_text(fitting.campaign(fitting.HIDDEN, 40, 11, 64, 96, more=ROUGH))
    sonject.done("campaign", "hidden.yaml", "-o", "contacts", "--quiet")
    sonject.done("fit", "start.yaml", "contacts/all/coco.json", "-o", "fitted.yaml", "--quiet")
    text = (folder / "fitted.yaml").read_text()
    start = (folder / "start.yaml").read_text()
    # the result is the user's own file, with its comments and other numbers
    assert [line.split("#")[1] for line in start.splitlines() if "#" in line] == [
        line.split("#")[1] for line in text.splitlines()[1:] if "#" in line]
    assert text.startswith("# Fitted by sonject")
    for name in ("start", "fitted"):
        sonject.done("campaign", f"{name}.yaml", "-o", f"as_{name}", "--set", "images=60", "--quiet")
    hidden, before, after = (fitting.drawn(folder / name) for name in ("contacts", "as_start", "as_fitted"))
    print(hidden, before, after)
    for kind in range(5):
        assert abs(after[kind] - hidden[kind]) < abs(before[kind] - hidden[kind])
    # 30 contacts give sizes to some 15 % and levels to 2 dB, and no such median was off by more
    assert all(abs(after[:3] / hidden[:3] - 1) < 0.3)
    assert all(abs(after[3:] - hidden[3:]) < 3)
    page = page_data(folder, "fitted.html")
    assert page["picture"] == "fitted.png" and (folder / "fitted.png").read_bytes().startswith(b"\x89PNG")
    assert "draw.objects[].heading\ndraw.objects[].burial.fraction" in page["unchanged"]
    (length,) = (draw for draw in page["draws"] if draw["key"] == "targets[0].draw.length")
    assert length["before"] == ["1.4 m", "3.2 m"]
    before = {draw["key"]: draw["before"] for draw in page["draws"]}
    assert before["visible.highlight"] == ["any"]
    assert f"length: {{log_uniform: [{', '.join(length['after'])}]}}" in text
    for extent in page["fit"]:
        assert sum(extent["bins"]) > 0 and sum(extent["before"]) > 0 and sum(extent["after"]) > 0


@pytest.mark.parametrize("contacts, output, message", [
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "fitted.yaml",
     "contacts.csv: has 1 contacts; a fit needs 10 or more"),
    ("image,row,column,rows,columns\n" + "".join(f"seabed_1.tif,295,{column},9,20\n" for column in range(10)), "fitted.yaml",
     "seabed_1.tif: "),
    ("image,row,column,rows,columns\n" + "seabed_1.tif,5,5,9,20\n" * 10, "fitted.yaml",
     "contacts.csv: has 1 contacts; a fit needs 10 or more"),
    # an image of two names
    ("image,row,column,rows,columns\n" + "".join(f"{name},{9 * row},5,9,20\n" for row in range(9) for name in (
        "seabed_1.tif", "./seabed_1.tif")), "fitted.yaml", "contacts.csv: has 9 contacts; a fit needs 10 or more"),
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "start.yaml",
     "start.yaml: is the campaign that is fitted; choose another name"),
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "../{here}/start.yaml",
     "start.yaml: is the campaign that is fitted; choose another name"),
    # the same folder by another name, so only the contacts are wrong
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "../{here}/fitted.yaml",
     "contacts.csv: has 1 contacts; a fit needs 10 or more"),
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "out/fitted.yaml",
     "out/fitted.yaml: must lie in the folder of start.yaml"),
])
def test_what_cannot_be_fitted_is_told(sonject, folder, contacts, output, message):
    (folder / "contacts.csv").write_text(contacts)
    before = sorted(path.name for path in folder.iterdir())
    done = sonject("fit", "start.yaml", "contacts.csv", "-o", output.format(here=folder.name))
    assert done.returncode == 3 and message in done.stderr
    assert sorted(path.name for path in folder.iterdir()) == before


@pytest.mark.parametrize("columns, rows", [(250, 150), (500, 150), (1000, 300)])
def test_labels_of_a_picture_of_another_size_are_refused(sonject, folder, columns, rows):
    message = f"seabed_1.tif: the labels say {columns} x {rows} pixels, the image has 500 x 300: "
    box = {"image_id": 1, "category_id": 1, "bbox": [5, 5, 20, 9]}
    (folder / "coco.json").write_text(json.dumps({
        "images": [{"id": 1, "file_name": "seabed_1.tif", "width": columns, "height": rows}],
        "categories": [{"id": 1, "name": "mine"}], "annotations": 12 * [box]}))
    (folder / "voc").mkdir()
    (folder / "voc" / "1.xml").write_text(
        f"<annotation><filename>seabed_1.tif</filename><size><width>{columns}</width><height>{rows}</height></size>"
        + 12 * ("<object><name>mine</name><bndbox><xmin>6</xmin><ymin>6</ymin><xmax>25</xmax><ymax>14</ymax></bndbox>"
                "</object>") + "</annotation>")
    for labels in ("coco.json", "voc"):
        assert_refused(sonject("fit", "start.yaml", labels, "-o", "fitted.yaml", "--quiet"), 3, message)


def test_contacts_of_a_class_are_fitted(sonject, folder):
    boulders = "".join(f"seabed_1.tif,{9 * i},5,9,20,boulder\n" for i in range(30))
    (folder / "contacts.csv").write_text("image,row,column,rows,columns,class\nseabed_1.tif,5,5,9,20,mine\n" + boulders)
    for name, message in [("mine", "has 1 contacts of the chosen classes; a fit needs 10 or more"),
                          ("mime", "holds no contacts of the chosen classes, but of mine (1), boulder (30)")]:
        done = sonject("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml", "--class", name)
        assert done.returncode == 3 and message in done.stderr


def test_bright_points_tell_no_heights(sonject, folder):
    """Bright points have no shadows. Sizes that nothing draws are not fitted."""
    points = images.read_tiff(folder / "seabed_1.tif").copy()
    contacts = "image,row,column,rows,columns,class\n"
    for row in range(20, 280, 20):
        points[row:row + 4, 200:203] = 5 * abs(points).mean()
        contacts += f"points.tif,{row - 2},198,12,14,point\n"
    (folder / "points.tif").write_bytes(images.tiff_bytes(points))
    (folder / "contacts.csv").write_text(contacts + "points.tif,5,5,9,20,other\n")
    start = fitting.campaign(fitting.START, 40, 3, 64, 96, ("box",), ROUGH)
    start += f"  - {{class: rock, object: {{shape: box, length: 1 m, width: 1 m, height: 1 m{ROUGH}}}}}\n"
    (folder / "start.yaml").write_text(start)
    done = sonject.done("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml", "--class", "point")
    text = (folder / "fitted.yaml").read_text()
    assert "height: {log_uniform: [0.4 m, 0.9 m]}" in text and "length: {log_uniform: [1.4 m" not in text
    assert "noise_floor" not in text and "shadow" not in text
    page = page_data(folder, "fitted.html")
    assert page["classes"] == ["point"]
    notes = page["notes"].splitlines()
    assert notes == ["only 0 of 13 contacts show a shadow, so heights and the noise floor stay as they are",
                     "sizes that are fixed or come from a table are not fitted: rock (length, width)"]
    assert page["unmatched"] and all(note in done.stderr for note in notes)
    told = done.stderr.splitlines()
    assert "seabed_1.tif tells other spacings" in done.stderr and len(told) == len(set(told))  # not in every round


def test_published_extents_move_what_they_tell(sonject, folder):
    """Shadows along the track tell lengths, but neither heights nor levels nor the noise floor."""
    start = fitting.campaign(fitting.START, 40, 3, 64, 96, ("box",), ROUGH)
    (folder / "start.yaml").write_text(start)
    (folder / "published.yaml").write_text(
        "quantiles: [0.1, 0.5, 0.9]\ncontacts: 80\nshadow_along: [0.5 m, 0.9 m, 1.8 m]\n")
    done = sonject.done("fit", "start.yaml", "published.yaml", "-o", "fitted.yaml")
    text = (folder / "fitted.yaml").read_text()
    note = ("published extents tell no levels, no noise floor and, without shadow_range, no heights; these stay")
    assert done.stderr.count(note) == 1
    page = page_data(folder, "fitted.html")
    assert note in page["notes"]
    moved = {draw["key"].rpartition(".")[2] for draw in page["draws"]}
    assert moved == {"length", "width"}
    kept = [line for line in start.splitlines() if "length:" not in line and "width:" not in line]
    assert [line for line in kept if line not in text] == []
    low, high = re.search(r"length: {log_uniform: \[([0-9.]+) m, ([0-9.]+) m", text).groups()
    assert float(low) * float(high) < 0.6 * 1.4 * 3.2  # their medians are 0.9 m and 2.1 m


def test_contacts_of_a_swath_have_the_ranges_of_the_scene_and_their_shadows(sonject, folder):
    """The seabeds' files say that range begins at 44 m, and the scene says 30 m, as injected contacts have it.
    Labels of highlights leave out the shadows, which are up to 150 pixels long."""
    things = [f"{{name: box, shape: box, length: {1 + i / 20} m, width: 0.7 m, height: 1 m, heading: {37 * i} deg, "
              f"level: {{over_seabed: 15 dB}}{ROUGH}, position: {{row: {30 + 48 * (i % 6)}, column: {60 + 200 * (i // 6)}}}}}"
              for i in range(12)]
    (folder / "contacts.yaml").write_text(fitting.SCENE.replace("input:", "input:\n  path: seabed_1.tif") + "objects:\n" + "".join(
        f"  - {thing}\n" for thing in things))
    sonject.done("run", "contacts.yaml", "-o", "run", "--quiet")
    (folder / "run" / "image.tif").replace(folder / "seabed_1.tif")
    boxes = [thing["highlight"] for thing in json.loads((folder / "run" / "truth.json").read_text())["objects"]]
    (folder / "contacts.csv").write_text("image,row,column,rows,columns\n" + "".join(
        f"seabed_1.tif,{box['row']},{box['column']},{box['rows']},{box['columns']}\n" for box in boxes))
    (folder / "start.yaml").write_text(fitting.campaign(fitting.START, 40, 3, 64, 340, ("box",), ROUGH).replace(
        "fraction: {uniform: [0, 0.3]}", "fraction: 0"))
    told = sonject.done("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml", "--boxes", "highlight").stderr
    text = (folder / "fitted.yaml").read_text()
    limits = [float(a) for a in re.search(r"range_over_altitude: \[([\d.]+), ([\d.]+)\]", text).groups()]
    middles = [(30 + 0.05 * (box["column"] + box["columns"] / 2)) / 8 for box in boxes]
    assert limits == pytest.approx([min(middles), max(middles)], abs=0.1)
    ends = [float(a) for a in re.search(r"height: \{log_uniform: \[([\d.]+) m, ([\d.]+) m\]", text).groups()]
    assert numpy.sqrt(numpy.prod(ends)) == pytest.approx(1, rel=0.25)  # the start is 0.6
    # images that cut the shadows, which their contacts' images do not
    note = "of the injected shadows, far more than of real ones, so heights come out too great"
    assert note not in told
    told = sonject.done("fit", "start.yaml", "contacts.csv", "-o", "cut.yaml", "--boxes", "highlight", "--set",
                        "chip.columns=96").stderr
    assert note in told and note in page_data(folder, "cut.html")["notes"]


@pytest.mark.parametrize("image", ["tile.tif", "seabed_1.tif", "seabed_3.tif"])
def test_an_image_that_tells_no_ranges_is_told(sonject, folder, image):
    """A tile of a line says nothing of itself. A seabed's file does, and a swath has the scene's geometry."""
    fitting.make_seabeds(sonject, numbers=(3,))
    pixels = images.read_tiff(folder / "seabed_1.tif")
    (folder / "tile.tif").write_bytes(images.tiff_bytes(pixels[:, 200:]))
    (folder / "seabed_1.tif").write_bytes(images.tiff_bytes(pixels))
    (folder / "contacts.csv").write_text(
        "image,row,column,rows,columns\n" + "".join(f"{image},{row},5,9,20\n" for row in (5, 50)))
    done = sonject("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml")
    assert done.returncode == 3 and "has 2 contacts; a fit needs 10 or more" in done.stderr
    note = "tile.tif is no swath of the campaign and tells no ranges: the scene's count, from 30 m on"
    assert done.stderr.count(note) == (image == "tile.tif") and done.stderr.count("no swath") == (image == "tile.tif")


def test_contacts_of_a_file_of_several_swaths_are_refused(sonject, folder):
    """Contacts in one array used to be measured in the other."""
    from scipy.io import savemat

    savemat(folder / "line.mat", {f"side_{number}": images.read_tiff(folder / f"seabed_{number}.tif") for number in (1, 2)})
    swaths = "swaths: [{path: line.mat, set: {input.array: side_1}}, {path: line.mat, set: {input.array: side_2}}]"
    start = (folder / "start.yaml").read_text()
    (folder / "start.yaml").write_text(re.sub("swaths: .*", swaths, start))
    (folder / "contacts.csv").write_text("image,row,column,rows,columns\n" + "".join(
        f"line.mat,{22 * row},5,9,20\n" for row in range(12)))
    assert_refused(sonject("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml", "--quiet"), 3,
                   "line.mat: has several arrays that are swaths of the campaign, and contacts do not say which: save")


def test_a_byte_order_mark_is_not_in_the_fitted_file(sonject, folder):
    """The comment goes before the first key, and a mark may only begin a file."""
    contacts = "".join(f"seabed_1.tif,{20 + 9 * i},5,9,20\n" for i in range(12))
    (folder / "contacts.csv").write_text("image,row,column,rows,columns\n" + contacts)
    (folder / "start.yaml").write_text((folder / "start.yaml").read_text(), encoding="utf-8-sig")
    sonject.done("check", "start.yaml")
    sonject.done("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml", "--quiet")
    assert b"\xef\xbb\xbf" not in (folder / "fitted.yaml").read_bytes()
    sonject.done("check", "fitted.yaml")


SIDES = """\
sonject: 1
input: {path: line.tif, geometry: {row_spacing: 5 cm, column_spacing: 5 cm, nadir_column: 599.5, side: port}}
sonar: {frequency: 300 kHz, bandwidth: 20 kHz, altitude: 5 m, resolution: 6 cm, response: hamming}
"""


def inject_contacts(sonject, folder, side, ranges):
    """Puts twelve boxes into a side of line.tif at these slant ranges, m. Returns CSV lines of the boxes of
    highlights and shadows."""
    objects = [f"{{name: box, shape: box, length: {1.2 + i / 40} m, width: 0.7 m, height: 0.45 m, heading: {40 * i} deg, "
               f"level: {{over_seabed: 15 dB}}{ROUGH}, position: {{along_track: {2 + 4 * i} m, slant_range: {r} m}}}}"
               for i, r in enumerate(ranges)]
    (folder / "contacts.yaml").write_text(SIDES.replace("port", side) + "objects:\n" + "".join(
        f"  - {thing}\n" for thing in objects))
    sonject.done("run", "contacts.yaml", "-o", f"with_{side}", "--quiet")
    (folder / f"with_{side}" / "image.tif").replace(folder / "line.tif")
    truth = json.loads((folder / f"with_{side}" / "truth.json").read_text())
    return "".join(f"line.tif,{','.join(str(thing[part][key]) for key in ('row', 'column', 'rows', 'columns'))},{part}\n"
                   for thing in truth["objects"] for part in ("highlight", "shadow"))


def test_contacts_are_measured_side_by_side(sonject, tmp_path):
    """Each side of the line has contacts at other ranges. Chips of a side lie at the ranges of its contacts."""
    fitting.make_seabeds(sonject, 1000, 600)
    sides = [images.read_tiff(tmp_path / f"seabed_{number}.tif") for number in (1, 2)]
    (tmp_path / "line.tif").write_bytes(images.tiff_bytes(numpy.hstack([sides[0][:, ::-1], sides[1]])))
    ratios = {"port": numpy.linspace(1.8, 2.8, 12), "starboard": numpy.linspace(3.2, 4.8, 12)}
    (tmp_path / "contacts.csv").write_text("image,row,column,rows,columns,part\n" + "".join(
        inject_contacts(sonject, tmp_path, side, 5 * ratio) for side, ratio in ratios.items()))
    (tmp_path / "scene.yaml").write_text(SIDES)
    (tmp_path / "start.yaml").write_text(fitting.campaign(fitting.START, 40, 3, 64, 96, ("box",), ROUGH).replace(
        "swaths: [{path: seabed_1.tif}, {path: seabed_2.tif}]", "swaths:" + "".join(
            f"\n  - path: line.tif\n    set: {{input.geometry.side: {side}}}" for side in ratios)))
    sonject.done("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml", "--quiet")
    assert page_data(tmp_path, "fitted.html")["contacts"] == 24  # of 48 boxes
    text = (tmp_path / "fitted.yaml").read_text()
    limits = numpy.array([(float(a), float(b)) for a, b in re.findall(
        r"range_over_altitude: \[([\d.]+), ([\d.]+)\]", text)])
    # a label covers highlight and shadow, and its middle lies some 0.2 behind the highlight
    expected = [(1.8, 4.8), (1.8, 2.8), (3.2, 4.8)]
    assert limits == pytest.approx(numpy.array(expected) + 0.2, abs=0.25)
    (length,) = (draw["after"] for draw in page_data(tmp_path, "fitted.html")["draws"]
                 if draw["key"] == "targets[0].draw.length")
    middle = numpy.sqrt(numpy.prod([float(end.split()[0]) for end in length]))
    assert middle == pytest.approx(1.34, rel=0.2)  # 24 contacts give it to some 15 %; the start is 2.1
    sonject.done("campaign", "fitted.yaml", "-o", "data", "--set", "images=20", "--quiet")
    records = list((tmp_path / "data" / "all" / "records").glob("*.json"))
    assert len(records) == 20
    for path in records:
        swath = json.loads(path.read_text())["swath"]
        ratio = abs(swath["column"] + 47.5 - 599.5) * 0.05 / 5
        is_port = swath["column"] < 600
        assert limits[1 if is_port else 2][0] <= ratio <= limits[1 if is_port else 2][1]
    # a swath that has places near the nadir alone
    near = ("{path: line.tif, set: {input.geometry.side: port}, avoid: [{row: 0, column: 0, rows: 1000, columns: 400}]}")
    told = sonject.done("fit", "start.yaml", "contacts.csv", "-o", "near.yaml", "--set", f"swaths[2]={near}").stderr
    assert "only images of swaths that show contacts are limited to them" in told
    assert re.findall(r"range_over_altitude: .*", (tmp_path / "near.yaml").read_text()) == re.findall(
        r"range_over_altitude: .*", text)[1:]


def test_contacts_of_a_recording_are_on_one_of_its_sides_or_on_chips(sonject, tmp_path):
    """Contacts are twelve stones on the starboard side, and twelve targets on the campaign's chips, TIFF without channels."""
    sides = [Made("amplitude", water=numpy.full(ROWS, 100), seed=seed).numbers for seed in (1, 2)]
    contacts = "image,row,column,rows,columns,side\n"
    for row in range(60, 780, 60):
        sides[1][row:row + 6, 300:306], sides[1][row:row + 6, 306:336] = 40000, 20
        contacts += f"line.xtf,{row - 2},298,10,40,starboard\n"
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(*sides, altitudes=100 * 30 / COLUMNS * numpy.ones(ROWS)))
    assert init(sonject, "line.xtf", "--channel", "port", "--campaign", answers=["", "100 kHz", "30 kHz", ""]).returncode == 0
    (tmp_path / "start.yaml").write_text(fitting.campaign({**fitting.START, "level": (7, 12)}, 12, 3, 64, 96, ("box",), ROUGH).replace(
        "scene.yaml", "line.yaml").replace("swaths: [{path: seabed_1.tif}, {path: seabed_2.tif}]", "swaths:" + "".join(
            f"\n  - path: line.xtf\n    set: {{input.channel: {side}}}" for side in ("port", "starboard"))))
    sonject.done("campaign", "start.yaml", "-o", "set", "--quiet")
    for path in sorted((tmp_path / "set" / "all" / "records").glob("*.json")):
        column, row, columns, rows = json.loads(path.read_text())["annotations"][0]["bbox"]
        contacts += f"set/all/images/{path.stem}.tif,{row},{column},{rows},{columns},\n"
    (tmp_path / "contacts.csv").write_text(contacts.replace("starboard", ""))
    done = sonject("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml")
    assert done.returncode == 3 and "line.xtf: shows two sides, which are two swaths of the campaign" in done.stderr
    (tmp_path / "labels").mkdir()
    (tmp_path / "labels" / "line.xtf").symlink_to(tmp_path / "line.xtf")
    (tmp_path / "labels" / "line.txt").write_text("0 0.5 0.5 0.1 0.1\n")
    done = sonject("fit", "start.yaml", "labels", "-o", "fitted.yaml")
    assert done.returncode == 3 and "line.txt:1: the recording has two sides, and the label does not say which" in done.stderr
    (tmp_path / "contacts.csv").write_text(contacts)
    done = sonject.done("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml")
    unmatched = page_data(tmp_path, "fitted.html")["unmatched"]  # stones of one size beside drawn targets
    assert unmatched and f"{len(unmatched)} measures of injected contacts do not match those of real ones" in done.stderr
    found = [sum(extent["bins"]) for extent in page_data(tmp_path, "fitted.html")["fit"] if extent]
    assert min(found) > 18, found  # there are 24 contacts, and the port side shows none of the stones
