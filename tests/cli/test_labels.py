"""Tests of a run's labels: boxes and masks in every format, contact records, places on the map."""

import csv
import json
import math
import os
import subprocess
import xml.etree.ElementTree

import numpy
import pytest

import images
import recordings
from measured_images import read_png
from conftest import COMMAND, COLUMNS, ROWS, assert_refused, write_text

# Square boxes would hide swapped rows and columns. The second target stands in the first one's shadow.
# The third target's shadow leaves the patch. The fourth target is buried.
SCENE = """\
sonject: 1
input:
  path: swath.tif
  geometry: {row_spacing: 5 cm, column_spacing: 2.5 cm, first_slant_range: 24 m}
patch: {row: 4, column: 8, rows: 80, columns: 112}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m, response: rectangular}
objects:
  - {name: 'a "b", <c> & d', class: 'x<&>y, "q"', shape: box, length: 1.6 m, width: 0.2 m,
     height: 0.3 m, heading: 0.1, position: {row: 60, column: 60}}
  - {name: ball, shape: sphere, diameter: 0.3 m, position: {row: 60, column: 80}}
  - {name: far ball, shape: sphere, diameter: 0.4 m, position: {row: 20, column: 110}}
  - {shape: sphere, diameter: 0.2 m, burial: 0.3 m, position: {row: 30, column: 30}}
"""
CLASSES = ['x<&>y, "q"', "sphere"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory, environment):
    """Makes a run with all labels and returns its folder."""
    place = tmp_path_factory.mktemp("labels")
    random = numpy.random.default_rng(4)
    swath = random.rayleigh(0.1, (ROWS, COLUMNS)).astype(numpy.float32)
    (place / "swath.tif").write_bytes(images.tiff_bytes(swath))
    (place / "scene.yaml").write_text(SCENE)
    subprocess.run([COMMAND, "run", "scene.yaml", "-o", "out", "--quiet", "--labels", "voc,yolo"],
                   cwd=place, env=environment, check=True)
    return place / "out"


def read_json(path):
    return json.loads(path.read_text())


@pytest.fixture(scope="module")
def seen(folder):
    """Returns {number of the object: mask of its pixels} from labels.png."""
    masks = numpy.zeros((ROWS, COLUMNS), numpy.uint8)
    for annotation in read_json(folder / "coco.json")["annotations"]:
        masks += annotation["object_id"] * decoded(annotation["segmentation"])
    labels = read_png(folder / "labels.png")
    assert numpy.array_equal(labels, masks)
    return {number: labels == number for number in (1, 2, 3, 4) if (labels == number).any()}


def decoded(segmentation):
    rows, columns = segmentation["size"]
    values = numpy.arange(len(segmentation["counts"])) % 2
    return numpy.repeat(values, segmentation["counts"]).reshape(columns, rows).T.astype("u1")


def box_of(mask):
    """Returns (row, column, rows, columns) of the pixels that are set."""
    rows, columns = numpy.nonzero(mask)
    return (rows.min(), columns.min(), numpy.ptp(rows) + 1, numpy.ptp(columns) + 1)


def test_every_format_has_the_boxes_of_the_masks(folder, seen):
    assert sorted(seen) == [1, 2, 3]
    boxes = {number: tuple(map(int, box_of(mask))) for number, mask in seen.items()}
    assert all(rows != columns for _, _, rows, columns in boxes.values())
    coco = read_json(folder / "coco.json")
    assert coco["images"] == [{"id": 1, "file_name": "image.tif", "width": COLUMNS, "height": ROWS}]
    assert [entry["name"] for entry in coco["categories"]] == CLASSES
    lines = (folder / "image.txt").read_text().splitlines()
    voc = xml.etree.ElementTree.parse(folder / "image.xml").getroot()
    assert [voc.find("size").find(key).text for key in ("width", "height", "depth")] == [
        str(COLUMNS), str(ROWS), "1"]
    assert (folder / "classes.txt").read_text().splitlines() == CLASSES
    labelled = zip(sorted(boxes), coco["annotations"], lines, voc.findall("object"), strict=True)
    for number, annotation, line, entry in labelled:
        row, column, rows, columns = boxes[number]
        name = CLASSES[number > 1]
        assert annotation["bbox"] == [column, row, columns, rows]
        assert annotation["area"] == seen[number].sum() > 0
        assert annotation["category_id"] == 1 + (number > 1)
        kind, *place = line.split()
        assert int(kind) == (number > 1)
        middle = ((column + columns / 2) / COLUMNS, (row + rows / 2) / ROWS)
        size = (columns / COLUMNS, rows / ROWS)
        assert [float(value) for value in place] == pytest.approx([*middle, *size], abs=1e-11)
        assert entry.find("name").text == name
        limits = [int(entry.find("bndbox").find(key).text)
                  for key in ("xmin", "ymin", "xmax", "ymax")]
        assert limits == [column + 1, row + 1, column + columns, row + rows]
        assert entry.find("truncated").text == str(int(annotation["truncated"]))
        assert entry.find("occluded").text == str(int(annotation["occluded"]))
    assert [entry["truncated"] for entry in coco["annotations"]] == [False, False, True]
    assert [entry["occluded"] for entry in coco["annotations"]] == [True, False, False]


def test_a_mask_across_all_rows_ends_where_it_ends(sonject, scene, tmp_path):
    """The mask begins in the first row and ends in the last one, in its last column, far from the image's end."""
    rod = {"shape": "cylinder", "length": 2.38, "diameter": 0.2, "heading": "6 deg"}
    sonject.done("run", scene, "-o", "out", "--set", f"objects={json.dumps([rod])}")
    labels = read_png(tmp_path / "out" / "labels.png")
    _, column, rows, columns = box_of(labels)
    assert rows == ROWS and column + columns < COLUMNS and labels[-1, column + columns - 1] == 1
    (annotation,) = read_json(tmp_path / "out" / "coco.json")["annotations"]
    assert numpy.array_equal(decoded(annotation["segmentation"]), labels)


def test_a_shadow_whose_highlight_lies_outside_is_truncated(sonject, scene, tmp_path):
    """The ball's middle lies in the patch, its near side in front of the patch's first column."""
    ball = {"shape": "sphere", "diameter": 0.6, "position": {"row": 60, "column": 13}}
    sonject.done("run", scene, "-o", "out", "--set", "patch={row: 4, column: 8, rows: 80, columns: 112}", "--set",
                 f"objects={json.dumps([ball])}")
    (thing,) = read_json(tmp_path / "out" / "truth.json")["objects"]
    assert thing["highlight"] is None and thing["shadow"]["column"] > 8 and not thing["shadow_cut"]
    (annotation,) = read_json(tmp_path / "out" / "coco.json")["annotations"]
    assert annotation["truncated"]


def test_labels_are_colours_that_read_as_numbers(sonject, folder, tmp_path):
    content = (folder / "labels.png").read_bytes()
    palette = content[content.index(b"PLTE") + 4 :][: 3 * 256]
    colours = {palette[3 * i : 3 * i + 3] for i in range(1, 256)}
    assert palette[:3] == bytes(3) and len(colours) == 255 and min(map(max, colours)) == 255
    sonject.done("convert", folder / "labels.png", "labels.npy")
    numbers = (tmp_path / "labels.npy").read_bytes()[-ROWS * COLUMNS :]
    assert numbers == read_png(folder / "labels.png").astype("u1").tobytes()
    assert set(numbers) == {0, 1, 2, 3}
    at = content.index(b"soNu")
    (tmp_path / "other.png").write_bytes(content[: at - 4] + content[at + 8 :])
    assert_refused(sonject("convert", "other.png", "other.npy"), 3, "palette")


def test_truth_says_where_boxes_lie_and_what_is_seen(folder, seen):
    truth = read_json(folder / "truth.json")
    bar, ball, far, buried = truth["objects"]
    assert truth["patch"]["corners"] is None and bar["position"] is None
    box = bar["highlight"]
    assert box["along_track_m"] == pytest.approx((box["row"] - 0.5) * 0.05)
    near = 24 + (box["column"] - 0.5) * 0.025
    assert box["slant_range_m"] == pytest.approx(near)
    assert box["ground_range_m"] == pytest.approx(math.sqrt(near**2 - 100))
    assert box["ground_width_m"] == pytest.approx(
        math.sqrt((near + 0.025 * box["columns"]) ** 2 - 100) - math.sqrt(near**2 - 100))
    # The bar along the track is 1.6 m long: 32 rows, and one or two more into which its echo spills.
    assert box["rows"] in (32, 33, 34)
    assert bar["dimensions"] == {"length_m": 1.6, "width_m": 0.2, "height_m": 0.3}
    taken = seen[2] & (read_png(folder / "highlight.png") > 0)
    taken = (taken & (numpy.indices(taken.shape)[1] < box_of(seen[1])[1] + box_of(seen[1])[3])).sum()
    assert bar["shadow_visible"] == pytest.approx(1 - taken / bar["shadow_pixels"], abs=0.01)
    assert 0.9 < bar["shadow_visible"] < 0.99 < bar["highlight_visible"] <= 1
    assert ball["shadow_visible"] == 1
    assert [entry["shadow_cut_by"] for entry in truth["objects"]] == [None, None, "patch", None]
    assert far["shadow_cut"] and not far["highlight_cut"] and far["highlight_cut_by"] is None
    assert not buried["visible"] and buried["shadow_visible"] is None
    assert buried["name"] == "object 4" and buried["class"] == "sphere"


def csv_lines(folder):
    with open(folder / "contacts.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_contact_records(folder, seen):
    truth = read_json(folder / "truth.json")["objects"]
    for entry, line in zip(truth, csv_lines(folder), strict=True):
        assert (line["image"], line["confidence"]) == ("image.tif", "1")
        for key in ("id", "name", "class", "row", "column", "slant_range_m", "ground_range_m"):
            assert line[key] == entry[key] or float(line[key]) == pytest.approx(entry[key])
        for key, size in entry["dimensions"].items():
            assert float(line[key]) == size
        assert float(line["heading_deg"]) == pytest.approx(entry["pose"]["heading_deg"])
        assert line["longitude_deg"] == line["easting_m"] == line["sonar_heading_deg"] == ""
        mask = seen.get(entry["id"])
        cells = [line[f"box_{key}"] for key in ("row", "column", "rows", "columns")]
        assert cells == ([""] * 4 if mask is None else [str(side) for side in box_of(mask)])
        assert int(line["pixels"]) == (0 if mask is None else mask.sum())
    assert csv_lines(folder)[0]["name"] == 'a "b", <c> & d'


def test_names_are_no_formulas_of_spreadsheets(sonject, scene, tmp_path):
    names = ["=cmd|' /c calc'!A0", "+1", "-1", "@SUM(1)"]
    objects = [{"name": name, "shape": "sphere", "diameter": 0.3,
                "position": {"row": 20 * (1 + i), "column": 60}} for i, name in enumerate(names)]
    sonject.done("run", scene, "-o", "out", "--set", f"objects={json.dumps(objects)}")
    assert [line["name"] for line in csv_lines(tmp_path / "out")] == ["'" + name for name in names]
    truth = read_json(tmp_path / "out" / "truth.json")["objects"]
    assert [entry["name"] for entry in truth] == names


STEERING = ["\x1b[31m", "\x9b31m", "\u202e", "\u2066", "\u200f", "\u061c", "\u2028"]


def test_names_that_steer_terminals_are_refused_and_never_shown(sonject, scene):
    for steering in STEERING:
        for key in ("objects[0].name", "objects[0].class", "input.path"):
            named = f"{key}={json.dumps(f'a{steering}b')}"
            assert_refused(sonject("check", scene, "--set", named), 3, key, "control characters")
    assert_refused(sonject("run", scene, "-o", "out", "--set", named), 3, key, "control characters")
    name = "a" + "".join(STEERING)
    assert_refused(sonject("run", scene, "-o", f"scene.yaml/{name}"), 5, "scene.yaml/a")
    answer = sonject.done("run", scene, "-o", name)
    assert len(answer.stderr.splitlines()) == 2 and "result is in a" in answer.stderr
    assert not any(steering in answer.stderr for steering in STEERING)


def test_pycocotools_reads_the_annotations(folder, seen, tmp_path):
    reader = os.environ.get("SONJECT_READERS")
    if not reader:
        pytest.skip("SONJECT_READERS does not name a Python that has pycocotools")
    script = ("import sys, numpy\n"
              "from pycocotools import mask\n"
              "from pycocotools.coco import COCO\n"
              "coco = COCO(sys.argv[1])\n"
              "for number in coco.getAnnIds(imgIds=coco.getImgIds()):\n"
              "    (entry,) = coco.loadAnns(number)\n"
              "    runs = coco.annToRLE(entry)\n"
              "    assert mask.area(runs) == entry['area'] > 0\n"
              "    assert list(mask.toBbox(runs)) == entry['bbox']\n"
              "    numpy.save(f\"{sys.argv[2]}/{entry['object_id']}.npy\", coco.annToMask(entry))\n"
              "assert len(coco.getAnnIds(catIds=coco.getCatIds(catNms=['sphere']))) == 2\n")
    subprocess.run([reader, "-c", script, folder / "coco.json", tmp_path], check=True,
                   env={**os.environ, "PYTHONPATH": ""})
    for number, mask in seen.items():
        assert numpy.array_equal(numpy.load(tmp_path / f"{number}.npy"), mask)


def test_a_finished_run_without_the_labels_is_run_again(folder, sonject, tmp_path):
    (tmp_path / "swath.tif").write_bytes((folder.parent / "swath.tif").read_bytes())
    (tmp_path / "scene.yaml").write_text(SCENE)
    result = tmp_path / "out"
    formats = {"image.txt": "yolo", "classes.txt": "yolo", "image.xml": "voc"}
    for asked, expected in ((["--labels", "voc"], {"image.xml"}), ([], {"image.xml"}),
                            (["--labels=yolo"], {"image.txt", "classes.txt"})):
        answer = sonject.done("run", "scene.yaml", "-o", "out", *asked)
        assert ("already" in answer.stderr) == (asked == [])
        assert {path.name for path in result.iterdir()} & set(formats) == expected
        assert set(read_json(result / "run.json")["labels"]) == {formats[name] for name in expected}
    for path in result.iterdir():
        if path.name not in ("run.json", "truth.json", "report.html"):
            assert path.read_bytes() == (folder / path.name).read_bytes(), path.name


@pytest.mark.parametrize("asked", ["yolo,", "coco", "", "yolo;voc"])
def test_unknown_labels_are_refused(sonject, tmp_path, asked):
    answer = sonject("run", "scene.yaml", "-o", "out", f"--labels={asked}")
    assert answer.returncode == 2 and "--labels" in answer.stderr
    assert len(answer.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


# The side, units of positions, recorded heading in degrees, and heading abeam of which contacts must lie, rad.
EAST = math.radians(89.0)
TRACKS = {
    "east across the date line, to starboard": ("starboard", 3, None, EAST),
    "the recorded heading, to port": ("port", 3, 10.0, math.radians(10.0)),
    "in metres": ("port", 0, None, EAST),
}


def metres_per_degree(latitude):
    """Returns the metres per degree of longitude and of latitude on the WGS 84 ellipsoid, from distances in
    space between points of its surface."""

    def point(longitude, latitude):
        a, e2 = 6378137.0, 1 - (1 - 1 / 298.257223563) ** 2
        n = a / math.sqrt(1 - e2 * math.sin(math.radians(latitude)) ** 2)
        x, y = math.radians(longitude), math.radians(latitude)
        return (n * math.cos(y) * math.cos(x), n * math.cos(y) * math.sin(x),
                n * (1 - e2) * math.sin(y))

    step = 1e-4
    return (math.dist(point(step, latitude), point(0, latitude)) / step,
            math.dist(point(0, latitude + step), point(0, latitude)) / step)


@pytest.mark.parametrize("case", TRACKS)
def test_contacts_lie_abeam_of_the_recorded_track(sonject, tmp_path, case):
    side, units, recorded, heading = TRACKS[case]
    scale = metres_per_degree(-40.0) if units else (1.0, 1.0)
    origin = (179.99999, -40.0) if units else (500000.0, 4000000.0)

    def at(along, abeam, bearing):
        """Returns the position that far along the track, which runs east by north, and abeam of the bearing."""
        turn = bearing + (math.pi / 2 if side == "starboard" else -math.pi / 2)
        x = along * math.sin(EAST) + abeam * math.sin(turn)
        y = along * math.cos(EAST) + abeam * math.cos(turn)
        return origin[0] + x / scale[0], origin[1] + y / scale[1]

    # Positions are recorded at every fourth ping and repeated in between. Two are missing, one of them
    # with its heading.
    data = recordings.file_header([recordings.PORT if side == "port" else recordings.STARBOARD],
                                  units=units)
    samples = numpy.random.default_rng(3).rayleigh(2000.0, (60, 200)).astype("<u2")
    for row, line in enumerate(samples):
        x, y = at(0.1 * (row - row % 4), 0.0, 0.0)
        x = (x + 180) % 360 - 180 if units else x
        place = (0.0, 0.0) if row in (30, 33) else (x, y)
        packet = bytearray(recordings.ping([(0, line)], position=place))
        if recorded is not None and row != 30:
            packet[212:216] = numpy.float32(recorded).tobytes()
        data += bytes(packet)
    (tmp_path / "line.xtf").write_bytes(data)
    write_text(tmp_path, "path: line.xtf", f"row_spacing: 0.1 m, column_spacing: 0.15 m, first_slant_range: 0.075 m, side: {side}",
               "{shape: sphere, diameter: 0.6 m, position: {row: 30, column: 100}}", "6 m",
               "frequency: 600 kHz, bandwidth: 10 kHz, resolution: 0.1 m", "patch: {row: 10, column: 60, rows: 40, columns: 120}")
    sonject.done("run", "scene.yaml", "-o", "out")
    truth = read_json(tmp_path / "out" / "truth.json")
    position = truth["objects"][0]["position"]
    keys = ("longitude_deg", "latitude_deg") if units else ("easting_m", "northing_m")
    wanted = [(30, truth["objects"][0]["ground_range_m"])]
    for row, column in ((10, 60), (10, 179), (49, 179), (49, 60)):
        wanted.append((row, math.sqrt((0.075 + 0.15 * column) ** 2 - 36)))
    told = [position, *truth["patch"]["corners"]]
    for (row, ground), place in zip(wanted, told, strict=True):
        x, y = at(0.1 * row, ground, heading)
        off = (place[keys[0]] - x + 180) % 360 - 180 if units else place[keys[0]] - x
        assert abs(off * scale[0]) < 1e-3 and abs((place[keys[1]] - y) * scale[1]) < 1e-3
        assert not units or -180 <= place["longitude_deg"] <= 180
    (line,) = csv_lines(tmp_path / "out")
    assert [float(line[key]) for key in keys] == pytest.approx(list(position.values()),
                                                               abs=1e-9 if units else 1e-4)
    assert float(line["sonar_heading_deg"]) == pytest.approx(math.degrees(heading), abs=1e-3)
