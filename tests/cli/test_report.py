"""Tests of report.html of runs and data sets: it agrees with the files beside it and needs no other file."""

import html.parser
import json
import re

import numpy
import pytest

import images
from conftest import page_data, write_text
from measured_images import read_png
from test_campaign import CAMPAIGN, SCENE
from test_run import DEMO

HOSTILE = "</script><b>&\"'é<!--"


class Page(html.parser.HTMLParser):
    """A parser that asserts that all tags are closed, and keeps addresses and texts."""

    VOID = {"meta", "link", "input", "img", "br"}

    def __init__(self, text):
        super().__init__()
        self.open, self.addresses, self.texts = [], [], {}
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        self.addresses += [value for name, value in attrs if name in ("src", "href", "action", "srcset", "data")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.setdefault(self.open[-1] if self.open else "", []).append(data)


def check_page(folder):
    """Asserts that the page is well-formed, needs no other file and has no markup in its data. Returns the data."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert text.startswith('<!DOCTYPE html>\n<html lang="en">')
    page = Page(text)
    assert not page.addresses
    # only a name of XML's looks like a host
    assert set(re.findall(r"\w+://[^\"'\s]*", text)) == {"http://www.w3.org/2000/svg"}
    data, _ = page.texts["script"]
    assert "<" not in data and json.loads(data) == page_data(folder)
    return page_data(folder)


def test_the_page_of_a_run_says_what_its_files_say(sonject, tmp_path):
    sonject.done("run", DEMO, "-o", "demo", "--set", f"objects[0].name={json.dumps(HOSTILE)}",
                 "--set", "injection.order_energies=true", "--set", "injection.interactions=2")
    folder = tmp_path / "demo"
    page = check_page(folder)
    truth, run = (json.loads((folder / name).read_text()) for name in ("truth.json", "run.json"))
    assert page["truth"] == truth and truth["objects"][0]["name"] == HOSTILE
    assert page["materials"] == ["steel", None, "steel"]
    assert page["notes"] == []
    assert [entry["name"] for entry in run["files"]] == [*page["files"], "report.html"]
    assert all((folder / name).is_file() for name in page["files"])
    for order in (1, 2):
        energy = images.read_tiff(folder / f"energy_order_{order}.tif").astype(float)
        told = page[f"energy_order_{order}.tif"]
        assert told["brightest_m2"] == pytest.approx(energy.max(), rel=1e-11)
        assert told["sum_m2"] == pytest.approx(energy.sum(), rel=1e-11)
    assert "energy_order_3.tif" not in page


def test_the_page_knows_the_panels_of_the_quicklook(sonject, scene, tmp_path, swath):
    sonject.done("run", scene, "-o", "result")
    look = page_data(tmp_path / "result")["quicklook"]
    picture = read_png(tmp_path / "result" / "quicklook.png").astype(int)
    assert picture.shape[:2] == (look["height"], look["width"])
    before, after, difference = [picture[each["top"] : each["top"] + each["height"], each["left"] : each["left"] + each["width"]]
                                 for each in look["panels"]]
    assert before.shape == after.shape == difference.shape
    window = slice(look["row"], look["row"] + look["rows"]), slice(look["column"], look["column"] + look["columns"])
    swath = swath[window]
    up = before.shape[0] // look["rows"]
    assert before.shape[:2] == tuple(up * side for side in swath.shape) and look["row_spacing_m"] == 0.025
    # grey rises with the amplitude, on the same scale before and after; the difference is white where nothing changed
    small = before[up // 2 :: up, up // 2 :: up, 0]
    order = numpy.argsort(swath, axis=None)
    assert (numpy.diff(small.ravel()[order]) >= 0).all() and small.min() == 0 and small.max() == 255
    same = read_png(tmp_path / "result" / "influence.png")[window] == 0
    same = numpy.kron(same, numpy.ones((up, up), bool))
    assert (before == after)[same].all() and not (before == after)[~same].all()
    assert (difference[same] == 247).all()


def test_the_quicklook_shows_what_changed_and_as_much_around_it(sonject, tmp_path):
    write_text(tmp_path, "synthetic: {rows: 300, columns: 500}", "row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 40 m",
               "{shape: sphere, diameter: 0.4 m, position: {row: 40, column: 300}}")
    sonject.done("run", "scene.yaml", "-o", "wide")
    rows, columns = numpy.nonzero(read_png(tmp_path / "wide" / "influence.png"))
    look = page_data(tmp_path / "wide")["quicklook"]
    margin = max(numpy.ptp(rows), numpy.ptp(columns)) + 1
    first = [max(0, rows.min() - margin), max(0, columns.min() - margin)]
    assert [look["row"], look["column"]] == first
    assert [look["row"] + look["rows"], look["column"] + look["columns"]] == [
        min(300, rows.max() + 1 + margin), min(500, columns.max() + 1 + margin)]
    assert look["first_along_track_m"] == pytest.approx(0.05 * first[0]) and look["first_range_m"] == pytest.approx(40 + 0.05 * first[1])
    sonject.done("run", "scene.yaml", "-o", "none", "--set", "objects=[]")
    assert page_data(tmp_path / "none")["quicklook"]["rows"] == 300


def test_notes_of_a_run_are_on_its_page(sonject, scene, tmp_path, swath):
    (tmp_path / "swath.png").write_bytes(images.png_bytes(numpy.full(swath.shape, 100, numpy.uint8)))
    done = sonject.done("run", scene, "-o", "result", "--set", "input.path=swath.png", "--verbose")
    notes = page_data(tmp_path / "result")["notes"]
    assert len(notes) >= 3 and any("is cut at the image's ceiling" in note for note in notes)
    told = {line.replace("sonject: ", "").replace("note: ", "") for line in done.stderr.splitlines()}
    assert set(notes) <= told and any(line.startswith("sonject: note: ") for line in done.stderr.splitlines())


def test_a_calibration_is_linked_where_it_was_made(sonject, scene, tmp_path):
    numbers = numpy.random.default_rng(3)
    (tmp_path / "swath.png").write_bytes(images.png_bytes(numbers.rayleigh(60, (600, 400)).clip(1, 255).astype(numpy.uint8)))
    patch = ["--set", "patch={row: 10, column: 10, rows: 96, columns: 128}"]
    sonject.done("run", scene, "-o", "result", "--set", "input.path=swath.png", "--set", "input.calibration=auto", *patch)
    page = check_page(tmp_path / "result")
    assert {"calibration.yaml", "calibration.png"} <= set(page["files"])
    assert page["truth"]["numbers"]["looks"]["from"] == "calibration" and page["swath"] == [600, 400]


@pytest.fixture
def data_set(sonject, tmp_path):
    """Makes a campaign of ten images and returns its folder."""
    numbers = numpy.random.default_rng(20261122)
    for i in range(3):
        (tmp_path / f"swath{i}.png").write_bytes(images.png_bytes(numbers.rayleigh(30, (110, 150)).clip(1, 255)))
    (tmp_path / "scene.yaml").write_text(SCENE)
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN.replace('ball, "big"/<b>', HOSTILE.replace("'", "''")))
    sonject.done("campaign", "campaign.yaml", "-o", "set")
    return tmp_path / "set"


def test_the_page_of_a_data_set_says_what_truth_says(data_set):
    page = check_page(data_set)
    assert page["classes"][0] == HOSTILE and page["every"] == 1
    assert page["columns"] == ["class", "shape", "visible", "slant_range_m", "over_seabed_db", "highlight_visibility_db",
                               "shadow_visibility_db", "row", "column", "rows", "columns"]
    assert sorted(row[0] for row in page["rows"]) == list(range(page["images"])) == list(range(10))
    counts = {split["name"]: dict.fromkeys(page["classes"], 0) for split in page["splits"]}
    for number, split, ending, _, objects, *sides in page["rows"]:
        assert sides == [64, 64]
        folder = data_set / page["splits"][split]["name"]
        assert (folder / "images" / f"{number:08d}{ending}").is_file()
        truth = json.loads((folder / "truth" / f"{number:08d}.json").read_text())
        assert len(objects) == len(truth["objects"])
        for row, each in zip(objects, truth["objects"]):
            told = dict(zip(page["columns"], row))
            box = each["box"] or {}
            expected = {**each, **each["level"], **{side: box.get(side) for side in ("row", "column", "rows", "columns")}}
            assert told == pytest.approx({name: expected[name] for name in told}, rel=1e-5)
            counts[folder.name][each["class"]] += 1
    assert {split["name"]: split["objects"] for split in page["splits"]} == {
        name: list(split.values()) for name, split in counts.items()}
    assert sum(sum(split.values()) for split in counts.values()) > 5
    records = [json.loads(path.read_text()) for path in data_set.glob("*/records/*.json")]
    assert page["cut"] == sum(any(each["truncated"] for each in record["annotations"]) for record in records)
    # images of the contact sheet lie where the page says, row by row
    assert page["sheet"]["images"] == list(range(10)) and page["chips"] == 0 and not (data_set / "chips").exists()
    sheet = read_png(data_set / "contact_sheet.png")
    empty = next(row for row in page["rows"] if not row[4])
    x, y = place(page["sheet"], empty[0])
    chip = read_png(data_set / page["splits"][empty[1]]["name"] / "images" / f"{empty[0]:08d}.png")
    assert (sheet[y : y + 64, x : x + 64] == chip[..., None]).all()


def place(sheet, cell):
    """Returns where a picture of images has a cell, as the page computes it."""
    return sheet["gap"] + cell % sheet["across"] * sheet["width"], sheet["gap"] + cell // sheet["across"] * sheet["height"]


@pytest.mark.parametrize("rows, columns, height", [(32, 64, 32), (24, 150, 28), ("all", 64, 110)])
def test_captions_stand_under_their_chips(sonject, data_set, tmp_path, rows, columns, height):
    """Chips are not square, but at most five times as wide as high. With all rows of a swath they have 110 here."""
    make(sonject, tmp_path, f"chip={{rows: {rows}, columns: {columns}, spread: 0}}", "targets[0].class=ball")
    sheet = read_png(tmp_path / "wide" / "contact_sheet.png")
    page = page_data(tmp_path / "wide")["sheet"]
    (left, top), below = place(page, 0), place(page, 8)
    assert below[0] == left == top == 6
    band = sheet[top + height : below[1], left : left + 20]
    ink = numpy.flatnonzero((band < 128).all(axis=2).any(axis=1))
    assert 2 <= ink[0] <= 6  # the row under the chip may hold a box's frame, which is not black
    assert 10 <= ink[-1] - ink[0] <= 14 and ink[-1] < 20
    if rows != "all":  # another swath may have more rows than this one
        assert len(band) == 28


def test_images_of_clutter_alone_have_its_class_for_a_caption(sonject, data_set, tmp_path):
    stone = "[{class: stone, object: {shape: sphere, diameter: 20 cm}}]"
    for clutter, is_named in (("{alone: 1, objects: %s}" % stone, True), ("{alone: 1, labelled: false, objects: %s}" % stone, False)):
        sheet = make(sonject, tmp_path, "empty=0", f"clutter={clutter}", "images=2")
        page = page_data(tmp_path / "wide")["sheet"]
        left, top = place(page, 0)
        caption = sheet[top + 64 : top + page["height"] - 6, left + 16 : left + 60]
        assert (caption < 128).any() == is_named


def make(sonject, folder, *settings):
    sonject.done("campaign", "campaign.yaml", "-o", "wide", "--overwrite", *(word for each in settings for word in ("--set", each)))
    return read_png(folder / "wide" / "contact_sheet.png")


def test_chips_are_drawn_to_scale_and_names_whole(sonject, data_set, tmp_path):
    """Rows are four times as long as columns. The targets' class name is too long for one line."""
    (tmp_path / "scene.yaml").write_text(SCENE.replace("row_spacing: 2.5 cm", "row_spacing: 10 cm"))
    chip, name = "chip={rows: 20, columns: 64, spread: 0}", "mine_of_a_long_name"
    short, long = (make(sonject, tmp_path, chip, f"targets[0].class={each}", "images=24") for each in (name[:4], name))
    page = page_data(tmp_path / "wide")
    assert {tuple(row[5:]) for row in page["rows"]} == {(80, 64)}
    assert len(long) - len(short) == 3 * 18
    named = [i for i, row in enumerate(page["rows"]) if row[4] and row[4][0][0] == name]
    x, y = place(page["sheet"], named[0])
    lines = [numpy.flatnonzero((long[y + 82 + 18 * line : y + 100 + 18 * line, x : x + 144] < 128).all(axis=2).any(axis=0)) for line in (0, 1)]
    assert all(len(line) > 30 and line[-1] < 142 for line in lines), lines


def test_images_whose_edge_cuts_a_contact_are_counted(sonject, data_set, tmp_path):
    """A shadow of 30 pixels and more is longer than half of a chip."""
    done = sonject.done("campaign", "campaign.yaml", "-o", "narrow", "--verbose", "--set", "empty=0.2", "--set",
                        "chip={rows: 64, columns: 40}")
    records = [json.loads(path.read_text()) for path in (tmp_path / "narrow").glob("*/records/*.json")]
    cut = [record for record in records if any(each["truncated"] for each in record["annotations"])]
    assert len(cut) > 3 and page_data(tmp_path / "narrow")["cut"] == len(cut)
    notes = [line for line in done.stderr.splitlines() if "edge" in line]
    assert len(notes) == 1 and f"note: {len(cut)} of 10 images have an object whose highlight or shadow is cut by the image's edge" in notes[0]
