"""Tests of campaigns: the data set's contents, which are the same however the set was made."""

import ctypes
import hashlib
import json
import pathlib
import random
import re
import shutil
import signal
import subprocess
import time

import numpy
import pytest

import images
import recordings
from conftest import COMMAND, assert_refused, files_below, page_data
from documents import SOURCE, comment_commands
from measured_images import read_png

ROWS, COLUMNS, CHIP = 110, 150, 64
IMAGES = 10

SCENE = """\
sonject: 1
input:
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 25 m}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}
"""

# Classes are data: none of these characters may reach a file's name.
CAMPAIGN = f"""\
sonject_campaign: 1
scene: scene.yaml
images: {IMAGES}
seed: 5
chip: {{rows: {CHIP}, columns: {CHIP}, spread: 0.4, clearance: 2}}
empty: 0.2
outputs: [highlight, shadow, masks, influence]
labels: [yolo, voc]
splits: {{train: 0.5, test: 0.5}}
swaths:
  - path: swath0.png
    avoid: [{{row: 0, column: 80, rows: 20, columns: 70}}]
  - path: swath1.png
  - path: swath2.png
draw:
  seabed.lambert: {{uniform: [-30 dB, -24 dB]}}
  objects[].burial: {{uniform: [0 cm, 5 cm]}}
targets:
  - class: 'ball, "big"/<b>'
    object: {{shape: sphere, diameter: 0.3 m}}
  - class: rod ÅÄ&
    object: {{shape: capsule, diameter: 0.2 m}}
    draw:
      length: {{log_uniform: [0.4 m, 0.6 m]}}
      burial: {{uniform: [0 mm, 50 mm]}}
      heading: {{uniform: [0 deg, 180 deg]}}
clutter:
  number: {{choice: [0, 1]}}
  objects:
    - class: stone
      object: {{shape: sphere, diameter: 0.2 m}}
"""
TARGETS = ['ball, "big"/<b>', "rod ÅÄ&"]


@pytest.fixture(scope="module")
def ground(tmp_path_factory):
    """Makes a folder with swaths, their scene and a campaign."""
    folder = tmp_path_factory.mktemp("campaign")
    numbers = numpy.random.default_rng(20261122)
    for i in range(3):
        amplitudes = numbers.rayleigh(30, (ROWS, COLUMNS)).clip(1, 255)
        (folder / f"swath{i}.png").write_bytes(images.png_bytes(amplitudes))
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "campaign.yaml").write_text(CAMPAIGN)
    return folder


@pytest.fixture(scope="module")
def command(ground, environment):
    """Runs the command where the campaign lies."""

    def run(*arguments):
        return subprocess.run([COMMAND, *map(str, arguments)], cwd=ground, env=environment,
                              capture_output=True, text=True, timeout=600)

    return run


def sets(*settings):
    return [part for text in settings for part in ("--set", text)]


@pytest.fixture(scope="module")
def made(ground, command):
    """Makes a data set with other settings and returns its folder."""

    def make(name, *settings):
        done = command("campaign", "campaign.yaml", "-o", name, *sets(*settings))
        assert done.returncode == 0, done.stderr
        return ground / name

    return make


@pytest.fixture(scope="module")
def whole(ground, command):
    """Makes the data set in one run and returns its folder."""
    answer = command("campaign", "campaign.yaml", "-o", "whole")
    assert (answer.returncode, answer.stderr) == (0, "sonject: the data set is in whole\n")
    return ground / "whole"


def contents(folder):
    """Returns the bytes of all files, by name, without the file of times."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in files_below(folder)
        if path.name != "times.json"
    }


def records(folder):
    """Returns the records of a campaign's folder, which has some."""
    found = [json.loads(path.read_text()) for path in sorted(folder.glob("*/records/*.json"))]
    assert found
    return found


def of_image(record, kind, extension):
    return f"{record['split']}/{kind}/{record['id']:08d}{extension}"


def truth_of(folder, record):
    return json.loads((folder / of_image(record, "truth", ".json")).read_text())


def picture_of(folder, record, kind="images"):
    return read_png(folder / of_image(record, kind, ".png"))


def cut_of(swath, record):
    """Returns the part of the swath that the image shows."""
    place = record["swath"]
    return swath[place["row"] : place["row"] + place["rows"], place["column"] : place["column"] + place["columns"]]


def drawn_of(record):
    return dict(entry.split("=", 1) for entry in record["set"])


def places_of(record):
    """Returns the objects' rows and columns in the swath."""
    return [(float(row), float(column)) for row, column in
            re.findall(r'"row": ([^,]+), "column": ([^}]+)}', drawn_of(record)["objects"])]


def test_every_image_has_its_files(whole):
    found = records(whole)
    assert sorted(record["id"] for record in found) == list(range(IMAGES))
    expected = {"campaign.json", "dataset.json", "report.html", "contact_sheet.png",
                "train/coco.json", "test/coco.json", "classes.txt", "data.yaml", "croissant.json", "swaths/0.png"}
    for record in found:
        assert record["image"] == f"images/{record['id']:08d}.png"
        expected |= {of_image(record, kind, ".png")
                     for kind in ("images", "highlight", "shadow", "masks", "influence")}
        expected |= {of_image(record, kind, ".json") for kind in ("truth", "records")}
        expected |= {of_image(record, "labels", ".txt"), of_image(record, "voc", ".xml")}
    assert set(contents(whole)) == expected
    assert len({record["seed"] for record in found}) == IMAGES


def test_what_is_avoided_is_shown_and_what_is_left_is_told(command, whole):
    """No chip begins at a row and column from which it reaches within 2 pixels of the box. The box's frame is the only orange
    part of the picture. It covers 20 of 110 rows and 70 of 150 columns, and a pixel more to either side."""
    rows, columns = numpy.mgrid[:ROWS - CHIP + 1, :COLUMNS - CHIP + 1]
    left = numpy.mean((rows >= 20 + 2) | (columns + CHIP <= 80 - 2))
    told = command("check", "campaign.yaml")
    assert (told.returncode, told.stdout) == (0, "")
    assert told.stderr == "".join(f"sonject: swath{i}.png: altitudes and avoid leave {100 * share:.4g} % of the places "
                                  "for images\n" for i, share in enumerate((left, 1, 1)))
    assert [round(swath["left"], 6) for swath in page_data(whole)["swaths"]] == [round(left, 6), 1, 1]
    picture = read_png(whole / "swaths" / "0.png")
    down, across = numpy.nonzero((picture == (255, 160, 0)).all(axis=2))
    panel = numpy.nonzero((picture.max(axis=2) < 250).mean(axis=1) > 0.4)[0]  # rows of pixels that show seabed
    up = round((panel.max() - panel.min()) / ROWS)
    assert numpy.ptp(down) + 1 == 20 * up + 2 and numpy.ptp(across) + 1 == 70 * up + 2


def test_no_swath_is_in_two_splits_and_classes_are_balanced_in_each(whole):
    splits = {}
    for record in records(whole):
        splits.setdefault(record["swath"]["hash"], set()).add(record["split"])
    assert sorted(map(len, splits.values())) == [1, 1, 1]
    assert set.union(*splits.values()) == {"train", "test"}
    # each split has five images: one is empty, the others have one of two targets
    for split in ("train", "test"):
        targets = [record["target"] for record in records(whole) if record["split"] == split]
        assert {name: targets.count(name) for name in [None, *TARGETS]} == {
            None: 1, TARGETS[0]: 2, TARGETS[1]: 2}
        # targets are mixed, so shards and the first images have all of them
        assert sum(one != other for one, other in zip(targets, targets[1:])) > 1


def test_images_keep_away_from_contacts_and_draws_are_stratified(whole):
    first = [record["swath"] for record in records(whole)
             if record["swath"]["path"] == "swath0.png"]
    assert first
    for place in first:
        assert 0 <= place["row"] <= ROWS - CHIP and 0 <= place["column"] <= COLUMNS - CHIP
        assert place["row"] >= 22 or place["column"] + CHIP <= 78
    lambert = sorted(float(text.split("=")[1].split()[0]) for record in records(whole)
                     for text in record["set"] if text.startswith("seabed.lambert="))
    assert [int((value + 30) / 6 * IMAGES) for value in lambert] == list(range(IMAGES))


def test_an_image_without_objects_is_the_swath(whole, ground):
    checked = 0
    for record in records(whole):
        if truth_of(whole, record)["objects"]:
            continue
        chip = cut_of(read_png(ground / record["swath"]["path"]), record)
        assert numpy.array_equal(picture_of(whole, record), chip)
        assert not picture_of(whole, record, "masks").any()
        checked += 1
    assert checked == 2


def test_the_influence_is_all_that_differs_from_the_swath(whole, ground):
    """The influence has all changed pixels and all pixels of the masks."""
    for record in records(whole):
        influence, masks = (picture_of(whole, record, kind) > 0 for kind in ("influence", "masks"))
        changed = picture_of(whole, record) != cut_of(read_png(ground / record["swath"]["path"]), record)
        assert not (changed & ~influence).any() and not (masks & ~influence).any()
        assert changed.sum() >= 0.5 * influence.sum()
        assert influence.any() == bool(record["annotations"])


def test_coco_is_what_truth_and_masks_say(whole):
    for split in ("train", "test"):
        coco = json.loads((whole / split / "coco.json").read_text())
        names = {entry["id"]: entry["name"] for entry in coco["categories"]}
        assert list(names.values()) == [*TARGETS, "stone"]
        ids = [entry["id"] for entry in coco["images"]]
        assert ids == sorted(ids) and len(ids) == IMAGES // 2
        assert [entry["id"] for entry in coco["annotations"]] == list(
            range(1, len(coco["annotations"]) + 1))
        for image in coco["images"]:
            mine = [entry for entry in coco["annotations"] if entry["image_id"] == image["id"]]
            truth = json.loads((whole / split / "truth" / f"{image['id']:08d}.json").read_text())
            seen = [each for each in truth["objects"] if each["visible"]]
            assert [names[entry["category_id"]] for entry in mine] == [each["class"] for each in seen]
            if len(seen) == 1:
                rows, columns = numpy.nonzero(read_png(whole / split / "masks" /
                                                       f"{image['id']:08d}.png"))
                assert mine[0]["bbox"] == [columns.min(), rows.min(), numpy.ptp(columns) + 1,
                                           numpy.ptp(rows) + 1]
                assert mine[0]["area"] == rows.size
                counts = mine[0]["segmentation"]["counts"]
                flat = numpy.repeat(numpy.arange(len(counts)) % 2, counts)
                assert numpy.array_equal(numpy.flatnonzero(flat),
                                         numpy.sort(columns * CHIP + rows))
            lines = (whole / split / "labels" / f"{image['id']:08d}.txt").read_text().splitlines()
            assert [int(line.split()[0]) + 1 for line in lines] == [
                entry["category_id"] for entry in mine]
    assert (whole / "classes.txt").read_text().splitlines() == [*TARGETS, "stone"]


def test_the_report_has_the_values_of_a_key_by_their_units(whole):
    histograms = page_data(whole)["histograms"]
    assert len(histograms) > 8
    assert sorted(each["unit"] for each in histograms if each["name"] == "objects[].burial") == ["cm", "mm"]
    (lambert,) = [each for each in histograms if each["name"] == "seabed.lambert"]
    assert sum(lambert["bins"]) == IMAGES and -30 <= lambert["low"] < lambert["high"] <= -24


def test_trainers_of_yolo_find_images_and_labels(whole):
    """By the rules of Ultralytics, paths begin at data.yaml's folder, and `labels` replaces `images` in a label's path."""
    card = [line.split(": ", 1) for line in (whole / "data.yaml").read_text().splitlines() if line[0] != "#"]
    folders = dict(card[: [entry[0] for entry in card].index("names:")])
    # there is no split for validation, and tests stay unseen
    assert folders == {"train": "train/images", "val": "train/images", "test": "test/images"}
    for folder in folders.values():
        found = sorted((whole / folder).iterdir())
        assert len(found) == IMAGES // 2
        assert all((path.parents[1] / "labels" / path.with_suffix(".txt").name).exists() for path in found)
    names = {int(key): json.loads(value) if value[0] == '"' else value for key, value in card[len(folders) + 1 :]}
    assert names == dict(enumerate([*TARGETS, "stone"]))


def test_clutter_need_not_be_labelled(made, whole):
    """Without labelled clutter there are only labels of targets. Truth, masks and the report's counts stay."""
    bare = made("unlabelled", "clutter.labelled=false")
    coco, every = (json.loads((folder / "train" / "coco.json").read_text()) for folder in (bare, whole))
    assert [each["name"] for each in coco["categories"]] == TARGETS
    told = [[(each["image_id"], each["object_id"], each["bbox"]) for each in document["annotations"]
             if each["category_id"] <= len(TARGETS)] for document in (coco, every)]
    assert told[0] == told[1] and len(coco["annotations"]) == len(told[0]) < len(every["annotations"])
    assert (bare / "classes.txt").read_text().splitlines() == TARGETS and "stone" not in (bare / "data.yaml").read_text()
    for path in files_below(bare / "train"):
        of_whole = whole / path.relative_to(bare)
        if path.parent.name in ("truth", "masks", "images"):
            assert path.read_bytes() == of_whole.read_bytes()
        elif path.suffix == ".txt":
            assert path.read_text() == "".join(line + "\n" for line in of_whole.read_text().splitlines() if line[0] != "2")
        assert path.suffix != ".xml" or b"stone" not in path.read_bytes()
    assert [page_data(bare)[key] for key in ("classes", "splits")] == [page_data(whole)[key] for key in ("classes", "splits")]


@pytest.mark.parametrize("splits, train, val, test", [
    ("test: 0.2, learn: 0.8", "learn", "learn", "test"), ("validation: 0.2, a: 0.6, test: 0.2", "a", "validation", "test"),
    ("val: 0.5, test: 0.5", "val", "val", "test"), ("a: 0.5, test: 0.2, b: 0.3", "a", "b", "test")])
def test_trainers_of_yolo_learn_from_no_test(made, splits, train, val, test):
    folder = made(splits.replace(": ", "").replace(", ", ""), f"splits={{{splits}}}", "images=5", "chip={rows: 16, columns: 16}")
    assert f"\ntrain: {train}/images\nval: {val}/images\ntest: {test}/images\n" in (folder / "data.yaml").read_text()


@pytest.mark.parametrize("splits, told", [("all: 1", "all"), ("train: 0.5, val: 0.5", None), ("train: 0.5, test: 0.5", "train")])
def test_a_run_says_once_which_images_validate_without_a_split_of_theirs(command, splits, told):
    done = command("campaign", "campaign.yaml", "-o", f"validates_{told}", "--verbose", *sets(
        f"splits={{{splits}}}", "images=2", "chip={rows: 16, columns: 16}"))
    assert done.returncode == 0, done.stderr
    notes = [line for line in done.stderr.splitlines() if "validation" in line]
    uses = f"{told}/images also for validation" if told else ""
    assert len(notes) == (told is not None) and all(uses in note for note in notes)


def test_croissant_lists_files_and_records(whole):
    """Further rules of mlcroissant are not tested here. They were tried: it finds no error and reads all records."""
    card = json.loads((whole / "croissant.json").read_text())
    assert card["conformsTo"] == "http://mlcommons.org/croissant/1.0"
    files = {entry["@id"]: entry for entry in card["distribution"] if entry["@type"] == "cr:FileObject"}
    assert set(files) == {"train/coco.json", "test/coco.json", "classes.txt", "contact_sheet.png",
                          "report.html", "data.yaml"}
    for name, entry in files.items():
        text = (whole / name).read_bytes()
        assert entry["sha256"] == hashlib.sha256(text).hexdigest()
        assert entry["contentSize"] == f"{len(text)} B"
    folders = {entry["includes"]: entry["encodingFormat"] for entry in card["distribution"]
               if entry["@type"] == "cr:FileSet"}
    assert folders["test/images/*"] == "image/png" and folders["train/truth/*"] == "application/json"
    assert {str(path.parent.relative_to(whole)) + "/*" for path in files_below(whole)
            if len(path.relative_to(whole).parts) == 3} == set(folders)
    sources = {field["source"][kind]["@id"] for each in card["recordSet"] for field in each["field"]
               for kind in ("fileObject", "fileSet") if kind in field.get("source", {})}
    assert sources == {"train/coco.json", "test/coco.json", "train/images", "test/images"}
    assert [(entry["classes/id"], entry["classes/name"]) for entry in card["recordSet"][0]["data"]] == [
        *enumerate([*TARGETS, "stone"], 1)]  # numbers as in COCO


def test_images_without_targets_come_as_often_as_asked(made):
    """The shares hold in each split, and the report shows them. Clutter without a target is at least one object."""
    folder = made("shares", "images=20", "empty=0.1", "clutter.alone=0.3", "clutter.number=0", "outputs=[]", "labels=[yolo]",
                  "targets[0].class=155")
    for split in ("train", "test"):
        mine = [record for record in records(folder) if record["split"] == split]
        objects = [len(truth_of(folder, record)["objects"]) for record in mine if record["target"] is None]
        assert len(mine) == 10 and sorted(objects) == [0, 1, 1, 1]
    page = page_data(folder)
    assert (page["images"], page["empty"], page["clutter_alone"]) == (20, 0.1, 0.3)
    assert [[split[key] for key in ("name", "images", "empty", "clutter_alone")] for split in page["splits"]] == [
        ["train", 10, 1, 3], ["test", 10, 1, 3]]
    assert '  0: "155"\n' in (folder / "data.yaml").read_text()  # a name, not a number


def test_the_report_counts_what_is_not_seen(made):
    """The report counts as many unseen objects as the images' truth."""
    folder = made("unseen", "outputs=[]", "labels=[]", "clutter.number=1", "draw={seabed.lambert: {uniform: [-30 dB, -24 dB]}}",
                  "targets=[{class: ball, object: {shape: sphere, diameter: 5 cm, burial: {proud: 3 mm}, level: {over_seabed: -30 dB}}}]")
    seen = [each["visible"] for record in records(folder) for each in truth_of(folder, record)["objects"]]
    unseen = seen.count(False)
    assert 0 < unseen != sum(seen) and page_data(folder)["unseen"] == unseen


def test_a_finished_data_set_is_left_alone(command, whole):
    before = {path: path.stat().st_mtime_ns for path in files_below(whole)}
    answer = command("campaign", "campaign.yaml", "-o", "whole")
    assert answer.returncode == 0 and "already holds the finished result" in answer.stderr
    assert {path: path.stat().st_mtime_ns for path in files_below(whole)} == before


def test_one_image_alone_is_the_same(command, whole, ground):
    number = next(record["id"] for record in records(whole) if record["target"] == TARGETS[1])
    assert command("campaign", "campaign.yaml", "-o", "alone", "--only", number).returncode == 0
    alone = contents(ground / "alone")
    assert len(alone) == 11  # its nine files, campaign.json and swaths/0.png
    assert alone.items() <= contents(whole).items()


def test_the_record_of_an_image_is_a_run(command, whole, ground):
    record = next(each for each in records(whole) if each["target"] == TARGETS[1])
    other = next(f"swath{i}.png" for i in range(3) if record["swath"]["path"] != f"swath{i}.png")
    answer = command("run", "scene.yaml", "-o", "run", *sets(f"input.path={other}", *record["set"]))
    assert answer.returncode == 0, answer.stderr
    assert numpy.array_equal(cut_of(read_png(ground / "run" / "image.png"), record), picture_of(whole, record))


def test_what_a_chip_cuts_goes_on_in_its_swath(whole, ground):
    told = set()
    for record in records(whole):
        place = record["swath"]
        end = read_png(ground / place["path"]).shape
        for thing in truth_of(whole, record)["objects"]:
            box = thing["shadow"]
            if not thing["shadow_cut"]:
                continue
            goes_on = (box["row"] == 0 < place["row"] or box["column"] == 0 < place["column"] or
                       box["row"] + box["rows"] == CHIP < end[0] - place["row"] or
                       box["column"] + box["columns"] == CHIP < end[1] - place["column"])
            assert thing["shadow_cut_by"] == ("patch" if goes_on else "swath")
            told.add(thing["shadow_cut_by"])
    assert "patch" in told


def test_grey_levels_are_not_of_decibels(command, ground):
    (ground / "decibels.yaml").write_text(SCENE.replace(
        "input:\n", "input:\n  transfer: {kind: decibel, parameter: 0.3, offset: -80}\n"))
    for verb in ("check", "campaign"):
        answer = command(verb, "campaign.yaml", *(["-o", "decibels"] if verb == "campaign" else []),
                         "--set", "scene=decibels.yaml", "--set", "grey=[-60 dB, 0 dB]")
        assert_refused(answer, 3, "grey: the numbers of swath0.png are dB already")


@pytest.mark.parametrize("kind, largest", [("<i2", 32767), ("<u4", 4294967295)])
def test_images_keep_the_full_scale_of_their_swath(ground, command, made, kind, largest):
    """Images of 16 bit integers with a sign, and of 32 bit ones, hold other types. Their levels are the swath's."""
    amplitudes = numpy.random.default_rng(9).rayleigh(0.1, (ROWS, COLUMNS)).clip(0.01, 1)
    numpy.save(ground / "swath.npy", (amplitudes * largest).astype(kind))
    settings = ("swaths=[{path: swath.npy}]", "splits={all: 1}", "empty=0", "images=1")
    (record,) = records(made(f"whole_numbers{kind[1:]}", *settings))
    grey = "grey=[-60 dB, 0 dB]"
    expected = picture_of(made(f"grey_numbers{kind[1:]}", *settings, grey), record)
    image = ground / f"whole_numbers{kind[1:]}" / of_image(record, "images", ".tif")
    assert command("convert", image, "grey.png", "--db", "-60:0").returncode == 0
    assert numpy.array_equal(read_png(ground / "grey.png"), expected)
    (ground / "grey.png").unlink()


def test_shards_and_merge_are_one_run(command, whole, ground):
    for shard in ("2/2", "1/2"):
        answer = command("merge", "shards")
        assert_refused(answer, 3, "no campaign" if shard == "2/2" else "5 of 10 images are missing: 0, 2")
        assert command("campaign", "campaign.yaml", "-o", "shards", "--shard", shard).returncode == 0
        made = {record["id"] % 2 for record in records(ground / "shards")}
        assert made == ({1} if shard == "2/2" else {0, 1})
    assert_refused(command("merge", "shards", "--labels", "voc"), 2, "take --labels out")
    assert command("merge", "shards").returncode == 0
    assert contents(ground / "shards") == contents(whole)


def wait_for_files(process, folder, count):
    """Waits until the folder has that many files or the process has ended."""
    end = time.monotonic() + 300
    while process.poll() is None and len(files_below(folder)) < count:
        assert time.monotonic() < end
        time.sleep(0.002)


def test_killed_four_times_it_goes_on(command, ground, environment, whole):
    numbers = random.Random(7)
    arguments = ["campaign", "campaign.yaml", "-o", "killed"]
    for _ in range(4):
        process = subprocess.Popen([COMMAND, *arguments], cwd=ground, env=environment,
                                   stderr=subprocess.PIPE)
        before = len(files_below(ground / "killed"))
        wait_for_files(process, ground / "killed", before + numbers.randint(1, 18))
        process.kill()
        process.communicate()
    assert command(*arguments).returncode == 0
    assert contents(ground / "killed") == contents(whole)


def test_what_a_killed_one_had_not_finished_is_removed(command, ground, environment, whole):
    """Its files in the making are named after the host and the process."""
    arguments = ["campaign", "campaign.yaml", "-o", "cut"]
    process = subprocess.Popen([COMMAND, *arguments], cwd=ground, env=environment, stderr=subprocess.PIPE)
    unfinished = []
    while process.poll() is None and not unfinished:
        unfinished = [path.name for path in files_below(ground / "cut") if ".part" in path.name]
    process.kill()
    process.communicate()
    owner = re.search(r"\.[0-9a-f]{8}-\d+-[0-9a-f]{16}\.part", unfinished[0]).group()
    for name in ("chips", "swaths", "calibrations"):
        (ground / "cut" / name).mkdir(exist_ok=True)
        (ground / "cut" / name / f"0.png{owner}.png").write_bytes(b"half")
    assert command(*arguments).returncode == 0
    assert not [path for path in files_below(ground / "cut") if ".part" in path.name]
    assert contents(ground / "cut") == contents(whole)


def stop_after_an_image(ground, environment, name):
    """Sends SIGTERM once the folder has more than one image's files. Returns exit code and message."""
    process = subprocess.Popen([COMMAND, "campaign", "campaign.yaml", "-o", name], cwd=ground,
                               env=environment, stderr=subprocess.PIPE, text=True)
    wait_for_files(process, ground / name, 15)
    process.send_signal(signal.SIGTERM)
    _, message = process.communicate(timeout=300)
    return process.returncode, message


def test_sigterm_keeps_finished_images(ground, environment, whole):
    # On a busy machine the command may be done before the signal is sent.
    for attempt in range(5):
        folder = ground / f"stopped{attempt}"
        code, message = stop_after_an_image(ground, environment, folder.name)
        assert contents(folder).items() <= contents(whole).items()
        if code != 0:
            break
    assert code == 85 and "run the same command again" in message
    assert 0 < len(records(folder)) < IMAGES


def test_it_stops_by_itself(command, ground):
    # No machine makes that many images side by side.
    arguments = ("campaign", "campaign.yaml", "--set", "images=100", "-o")
    assert command(*arguments, "all_at_once").returncode == 0
    made = [0]
    for _ in range(2):
        answer = command(*arguments, "timed", "--exit-after", "1e-9")
        assert (answer.returncode, answer.stderr) == (
            85, "sonject: stopped; run the same command again\n")
        made.append(len(records(ground / "timed")))
        assert made[-2] < made[-1] < 100
    # Lost files of an image are made again.
    before = contents(ground / "timed")
    for kind in ("masks", "images"):
        next((ground / "timed").glob(f"*/{kind}/*.png")).unlink()
        answer = command(*arguments, "timed", "--exit-after", "1e-9")
        assert answer.returncode == 85 and before.items() <= contents(ground / "timed").items()
    assert contents(ground / "timed").items() <= contents(ground / "all_at_once").items()


def test_the_first_image_that_fails_is_told(command, ground):
    # Images are made side by side. Those before the failed image are there, whichever ended first.
    for attempt in range(3):
        folder = ground / f"failing{attempt}"
        for image in (24, 25, 26):
            (folder / "train" / "images" / f"{image:08}.png").mkdir(parents=True)
        answer = command("campaign", "campaign.yaml", "-o", folder.name, "--set", "images=100")
        assert_refused(answer, 5, "images/00000024.png")
        made = {record["id"] for record in records(folder)}
        assert made >= set(range(24)) and len(made) < 60


def test_a_head_that_was_tampered_with_is_refused(command, whole, ground):
    head = json.loads((whole / "campaign.json").read_text())
    (ground / "odd").mkdir()
    for change in ({"classes": [1, 2, 3]}, {"classes": {}}, {"classes": ["a\nb"]}, {"splits": []},
                   {"splits": [{"name": "<b>", "images": 20}]}, {"rows": 10**18}, {"rows": "64"},
                   {"splits": [{"name": "train", "images": -1}]}, {"outputs": None}, {"images": 9},
                   {"swaths": None}, {"swaths": [{"path": "\u202e"}]}, {"sonject_campaign": "2"}):
        (ground / "odd" / "campaign.json").write_text(json.dumps({**head, **change}))
        assert_refused(command("merge", "odd"), 3, "odd/campaign.json", "damaged")
    (ground / "odd" / "campaign.json").write_text(json.dumps({**head, "sonject_campaign": 2}))
    assert_refused(command("merge", "odd"), 2, "odd: is of another version of sonject")


@pytest.mark.parametrize("setting, differs", [
    ("seed=6", "seed (5 there, 6 here)"), ("images=6", "images (10 there, 6 here)"),
    ("targets[0].object.diameter=20 cm", "targets"), ("scene=other.yaml", "scene"),
    ("swaths[1].path=swath2.png", "swaths")])
def test_another_campaign_is_refused_by_name(command, whole, ground, setting, differs):
    (ground / "other.yaml").write_text(SCENE.replace("altitude: 10 m", "altitude: 11 m"))
    before = contents(whole)
    answer = command("campaign", "campaign.yaml", "-o", "whole", "--set", setting)
    assert_refused(answer, 2, "whole", f"differs in {differs}", "--overwrite")
    assert contents(whole) == before


def test_another_campaign_leaves_nothing_behind_once_it_is_overwritten(command, whole, ground):
    folder = ground / "replaced"
    shutil.copytree(whole, folder)
    changes = sets("images=4", "splits={all: 1}", "labels=[voc]")
    assert command("campaign", "campaign.yaml", "-o", "fresh", *changes).returncode == 0
    replace = ["campaign", "campaign.yaml", "-o", "replaced", *changes, "--overwrite"]
    assert_refused(command(*replace, "--shard", "1/2"), 2, "--only 0 --overwrite")
    assert contents(folder) == contents(whole)
    answer = command(*replace)
    assert answer.returncode == 0, answer.stderr
    assert contents(folder) == contents(ground / "fresh")


@pytest.fixture
def damaged(whole, ground, tmp_path_factory):
    """Makes a copy of the data set that tests may damage."""
    folder = ground / tmp_path_factory.mktemp("copy").name
    shutil.copytree(whole, folder)
    return folder


def harm(path):
    path.write_bytes(path.read_bytes()[:-1] + b"?")


def test_what_was_changed_is_named_by_merge_and_made_again(command, damaged, whole):
    record = next(each for each in records(damaged) if each["target"])
    paths = [damaged / of_image(record, kind, extension) for kind, extension in (
        ("masks", ".png"), ("images", ".png"), ("truth", ".json"), ("labels", ".txt"),
        ("records", ".json"))]
    for path in paths:
        sound = path.read_bytes()
        for change in (harm, lambda path: path.write_bytes(b""), pathlib.Path.unlink):
            change(path)
            words = [f"missing or changed: {record['id']};", str(path.relative_to(damaged))]
            if not path.exists() and path == paths[-1]:
                words = [f"missing: {record['id']};"]
            assert_refused(command("merge", damaged.name), 3, "1 of 10 images", *words)
            path.write_bytes(sound)
    # five images, each with another file changed or missing
    for number, (each, path) in enumerate(zip(records(damaged), paths)):
        change = harm if number % 2 else pathlib.Path.unlink
        change(damaged / of_image(each, path.parent.name, path.suffix))
    assert command("campaign", "campaign.yaml", "-o", damaged.name).returncode == 0
    assert contents(damaged) == contents(whole)


def test_documents_that_were_changed_are_made_again(command, damaged, whole):
    names = ["train/coco.json", "classes.txt", "contact_sheet.png",
             "report.html", "data.yaml", "croissant.json", "dataset.json"]
    for changed in (*[[name] for name in names], names):
        for name in changed:
            harm(damaged / name) if len(changed) == 1 else (damaged / name).unlink()
        answer = command("campaign", "campaign.yaml", "-o", damaged.name)
        assert answer.returncode == 0 and "already" not in answer.stderr
        assert contents(damaged) == contents(whole)


def test_records_are_believed_as_they_were_written_alone(command, damaged):
    """A record is refused if a value has changed or if it is another image's."""
    first, second = [each for each in records(damaged) if each["annotations"]][:2]
    path = damaged / of_image(first, "records", ".json")
    sound = path.read_text()
    changes = {
        "image": "../../swath0.png", "id": 99, "seed": first["seed"] + 1, "set": [], "files": [],
        "target": "whale", "annotations": [], "script": "<script>", "xxh3": "0" * 32}
    before = contents(damaged)
    for text in [*(json.dumps({**first, key: value}) for key, value in changes.items()),
                 json.dumps(second), "[]", "[" * 10000]:
        path.write_text(text)
        assert_refused(command("merge", damaged.name), 3, "images are missing or changed",
                       str(path.relative_to(damaged)))
    path.write_text(sound)
    assert contents(damaged) == before


class Digest(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


def hashed(record):
    """Returns the record's text with the hash that the command would give it."""
    jansson, xxhash = ctypes.CDLL("libjansson.so.4"), ctypes.CDLL("libxxhash.so.0")
    jansson.json_loads.restype, jansson.json_dumps.restype = ctypes.c_void_p, ctypes.c_char_p
    jansson.json_dumps.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    digest = xxhash.XXH3_128bits
    digest.restype, digest.argtypes = Digest, [ctypes.c_char_p, ctypes.c_size_t]
    compact = jansson.json_dumps(jansson.json_loads(json.dumps(record).encode(), 0, None), 0x20)
    own = digest(compact + b"\0", len(compact) + 1)
    return f'{compact.decode()[:-1]},"xxh3":"{own.high:016x}{own.low:016x}"}}'


def test_records_with_a_hash_of_their_own_do_no_harm(command, damaged):
    """The records are forged with a valid hash."""
    record = next(each for each in records(damaged) if each["annotations"])
    path = damaged / of_image(record, "records", ".json")
    del record["xxh3"]
    outside = [{**record["files"][0], "name": "../" + record["split"] + "/" + record["files"][0]["name"]}]
    for change in ({}, {"files": outside}, {"target": "whale" * 99, "set": [1, "<b>=1 <script>", "=1", "a="]},
                   {"annotations": None, "set": None},
                   {"annotations": [1, {"bbox": ["0"]}, {"bbox": [2**63 - 1] * 4, "category_id": -1}]}):
        path.write_text(hashed({**record, **change}))
        answer = command("merge", damaged.name)
        if "files" in change:
            assert_refused(answer, 3, "not as it was written", outside[0]["name"])
        elif change.get("annotations"):
            assert answer.returncode in (0, 3), answer.stderr
        else:
            assert answer.returncode == 0, answer.stderr
        page = (damaged / "report.html").read_text()
        assert page.count("<script") == page.count("</script") == 2 and page_data(damaged)["images"] == IMAGES


RING = ('targets=[{class: ring, object: {shape: torus}, draw: {diameter: {uniform: [0.4 m, 1 m]}, '
        'height: {uniform: [0.1 m, %s]}}}]')


def test_values_that_do_not_go_together_are_drawn_anew(ground, command, made):
    """A torus must be more than twice as wide as it is high. A third of these draws is not, and the
    largest width and height do not go together either."""
    settings = [RING % "0.5 m", "empty=0", "images=12"]
    found = records(made("anew", *settings))
    anew = [record for record in found if "drawn_anew" in record]
    assert len(found) == 12 and 1 <= len(anew) <= 10
    for record in found:
        diameter, height = (float(drawn_of(record)[f"objects[0].{key}"].split()[0]) for key in ("diameter", "height"))
        assert diameter > 2 * height
    for record in anew:
        assert record["drawn_anew"]["times"] >= 1
        assert "or there is no hole" in record["drawn_anew"]["because"]
    page = page_data(ground / "anew")
    assert page["drawn_anew"] == len(anew)
    assert {id: because for id, _, _, because, *_ in page["rows"] if because} == {
        record["id"]: record["drawn_anew"]["because"] for record in anew}
    only = command("campaign", "campaign.yaml", "-o", "one", "--only", anew[0]["id"], *sets(*settings))
    assert only.returncode == 0, only.stderr
    name = of_image(anew[0], "records", ".json")
    assert (ground / "one" / name).read_bytes() == (ground / "anew" / name).read_bytes()


def test_what_can_never_be_drawn_is_refused_before_the_first_image(command, ground):
    answer = command("campaign", "campaign.yaml", "-o", "never", "--set", RING.replace("0.1 m", "0.6 m") % "0.8 m")
    assert_refused(answer, 3, "diameter", "or there is no hole")
    assert "image 0" not in answer.stderr
    assert not (ground / "never").exists()


FAINT = ["targets=[{class: ball, object: {shape: sphere, diameter: 0.3 m}, draw: {level.over_seabed: {uniform: [0 dB, 30 dB]}}}]",
         "clutter={objects: [{class: stone, object: {shape: sphere, diameter: 0.2 m}}], number: 0}", "empty=0", "images=12"]


def test_a_place_where_no_target_is_seen_is_left_after_eight_draws(made):
    places = {}
    for name, visible in ("all", "shadow: 60 dB"), ("some", "highlight: 6 dB"), ("none", "shadow: -60 dB"):
        for record in records(made(name, *FAINT, "images=6", f"visible={{{visible}}}")):
            times = record.get("drawn_anew", {"times": 0})["times"]
            places.setdefault(record["id"], []).append((times, *(record["swath"][key] for key in ("path", "row", "column"))))
    assert len(places) == 6
    draws = [times for first, *others in places.values() for times, *_ in others]
    assert 0 < sum(0 < times < 8 for times in draws) and sum(times >= 8 for times in draws) >= 6
    for (times, *first), *others in places.values():
        assert times == 0
        for times, *place in others:
            assert place[0] == first[0] and (place == first) == (times < 8)


VISIBLE = "visible={highlight: 6 dB, shadow: -1 dB, otherwise: %s}"


def stands_out(truth):
    return (truth["highlight_visibility_db"] or -99) >= 6 and (truth["shadow_visibility_db"] or 99) <= -1


@pytest.mark.parametrize("otherwise", ["difficult", "redraw"])
def test_targets_are_seen_as_they_are_to_be(made, otherwise):
    """Targets that are seen too little are drawn anew, or they alone are marked difficult."""
    folder = made(otherwise, VISIBLE % otherwise, *FAINT)
    found = records(folder)
    faint = []
    clipped = 0
    for record in found:
        (truth,) = truth_of(folder, record)["objects"]
        clipped += (truth["highlight_clipped"] or 0) > 0.1
        is_seen = stands_out(truth)
        for annotation in record["annotations"]:
            assert annotation.get("difficult", False) == (not is_seen)
        text = (folder / of_image(record, "voc", ".xml")).read_text()
        assert ("<difficult>1</difficult>" in text) == (not is_seen and bool(record["annotations"]))
        faint += [record["id"]] * (not is_seen)
    anew = [record["drawn_anew"]["because"] for record in found if "drawn_anew" in record]
    page = page_data(folder)
    marked = [each for record in found for each in record["annotations"] if each.get("difficult")]
    assert page["clipped"] == clipped > 0 and page["difficult"] == len(marked) and page["drawn_anew"] == len(anew)
    if otherwise == "difficult":
        assert 1 <= len(faint) < 12 and not anew
    else:
        assert not faint and 1 <= len(anew) < 12 and all("seen too little" in each and "nan" not in each for each in anew)


@pytest.mark.parametrize("settings, rows, columns", [
    (["chip.rows=all", "chip.columns=all"], ROWS, COLUMNS), (["chip.columns=all", "chip.edge=3"], CHIP, COLUMNS - 6)])
def test_images_may_be_whole_swaths_with_several_targets(made, settings, rows, columns):
    """Targets keep away from contacts and from the water column, here 40 columns wide."""
    folder = made(f"all{rows}", *settings, "targets_per_image={choice: [3, 5]}", "chip.spread=1", "empty=0.1", *(
        f"swaths[{i}].set={{input.geometry.first_slant_range: 9 m}}" for i in range(3)))
    counts = []
    for record in records(folder):
        place = record["swath"]
        assert (place["rows"], place["columns"]) == picture_of(folder, record).shape == (rows, columns)
        objects = truth_of(folder, record)["objects"]
        counts.append(record["targets"])
        assert [each["class"] in TARGETS for each in objects] == [
            *[True] * record["targets"], *[False] * (len(objects) - record["targets"])]
        places = places_of(record)
        assert len(places) == len(objects)
        for row, column in places:
            assert 40 <= column <= COLUMNS - 1 and place["row"] <= row <= place["row"] + rows - 1
            assert place["path"] != "swath0.png" or row >= 22 or column <= 78
    assert set(counts) == {0, 3, 5}
    coco = json.loads((folder / "train" / "coco.json").read_text())
    assert {(each["height"], each["width"]) for each in coco["images"]} == {(rows, columns)}
    assert json.loads((folder / "campaign.json").read_text())["columns"] == "all"


def test_images_with_a_contact_across_the_line_lie_where_objects_may(ground, command):
    settings = sets("chip.columns=all", "empty=0", f"swaths[0].avoid=[{{row: 0, column: 0, rows: 60, columns: {COLUMNS}}}]")
    done = command("campaign", "campaign.yaml", "-o", "across", *settings)
    assert done.returncode == 0 and "note" not in done.stderr, done.stderr
    near = command("campaign", "campaign.yaml", "-o", "near", *settings, *sets("chip.clearance=0", "images=3"))
    assert near.returncode == 0 and near.stderr.count("note: chip.clearance is 0") == 1
    first = [record["swath"]["row"] for record in records(ground / "across")
             if record["swath"]["path"] == "swath0.png"]
    # the middle 0.4 of 64 rows ends at the chip's row 44.1, the box with its clearance at row 62
    assert first and min(first) >= 18


def test_of_several_targets_the_faint_ones_alone_are_drawn_anew(made):
    """If faint targets are not drawn anew, they alone are difficult. All other targets stay in place."""
    levels, are_seen, places = {}, {}, {}
    for otherwise in ("difficult", "redraw"):
        folder = made(f"two_{otherwise}", VISIBLE % otherwise, *FAINT, "targets_per_image=3", "chip.spread=0.6")
        for record in records(folder):
            truths = truth_of(folder, record)["objects"]
            assert len(truths) == record["targets"] == 3
            key = otherwise, record["id"]
            are_seen[key] = [stands_out(each) for each in truths]
            levels[key] = [value for name, value in drawn_of(record).items() if "over_seabed" in name]
            places[key] = places_of(record)
            for each in record["annotations"]:
                assert each.get("difficult", False) != are_seen[key][each["object_id"] - 1]
    first, last = ([[each[otherwise, i] for i in range(12)] for each in (levels, are_seen)]
                   for otherwise in ("difficult", "redraw"))
    assert all(map(all, last[1])) and not all(map(all, first[1]))
    kept = [[old == new for old, new in zip(*pair)] for pair in zip(first[0], last[0])]
    assert all(is_kept <= was_seen for each in zip(kept, first[1]) for is_kept, was_seen in zip(*each))
    # a seen target changes only if the new place of another one hides it
    assert sum(map(sum, kept)) >= 0.8 * sum(map(sum, first[1]))
    stayed = [[old == new for old, new in zip(places["difficult", i], places["redraw", i])] for i in range(12)]
    assert stayed == kept


def test_objects_may_lie_at_the_border(made):
    """Boxes are cut at the border and marked as truncated."""
    cut = 0
    places = []
    for record in records(made("border", "chip.spread=1", "images=24")):
        places += [(row - record["swath"]["row"], column - record["swath"]["column"]) for row, column in places_of(record)]
        for each in record["annotations"]:
            column, row, columns, rows = each["bbox"]
            assert 0 <= column and 0 <= row and column + columns <= CHIP and row + rows <= CHIP
            is_at_edge = column == 0 or row == 0 or column + columns == CHIP or row + rows == CHIP
            assert each["truncated"] <= is_at_edge
            cut += each["truncated"]
    # in more than half of a chip's area, an edge is nearer than the length of an object and its shadow
    assert cut >= 6
    assert len(places) >= 24
    for axis in zip(*places):  # 10 % of uniform numbers lie that near to each end
        assert 0 <= min(axis) < 0.1 * CHIP and 0.9 * CHIP < max(axis) <= CHIP - 1


def coded_shares(image, blocks, table):
    """Returns for each 8 x 8 block the share of its discrete cosine transform that lies at multiples of the table, as in a
    decoded JPEG. Rounding to grey levels moves coefficients by 0.29, five times of which is allowed."""
    angles = numpy.pi * numpy.outer(numpy.arange(8), 2 * numpy.arange(8) + 1) / 16
    cosines = numpy.cos(angles) * numpy.where(numpy.arange(8) > 0, 0.5, 8**-0.5)[:, None]
    levels = [cosines @ (image[row : row + 8, column : column + 8] - 128) @ cosines.T for row, column in blocks]
    return [(numpy.abs(each - table * numpy.round(each / table)) < 5 * 0.29).mean() for each in levels]


@pytest.mark.parametrize("quality", [40, 75])
def test_images_of_a_jpeg_are_coded_as_it_is(ground, made, quality):
    """Injected blocks are coded like the input's, so only the target betrays them. Other blocks survive the second coding
    unchanged. In lossless images, injected blocks were never coded."""
    pillow = pytest.importorskip("PIL.Image")
    numbers = numpy.random.default_rng(20261126)
    amplitudes = numbers.rayleigh(1, (200, 260))
    levels = 140 + 80 * numpy.log10(amplitudes + numpy.roll(amplitudes, 1, 0))  # a quarter of a dB for each level
    source = ground / f"coded{quality}.jpg"
    pillow.fromarray(levels.clip(1, 255).astype("u1")).save(source, quality=quality)
    swath = numpy.array(pillow.open(source)).astype(float)
    table = numpy.reshape(pillow.open(source).quantization[0], (8, 8))
    shares = {}
    for form in ("as_input", "lossless"):
        folder = made(f"{form}{quality}", f"format={form}", "splits={all: 1}", "outputs=[influence]", "images=8", "chip.edge=3",
                      f"swaths=[{{path: {source.name}, avoid: [{{row: 0, column: 100, rows: 9, columns: 50}}], "
                      "set: {input.transfer: {kind: decibel, parameter: 0.25}}}]")
        found = {"input": [], "injected": [], "left": []}
        for record in records(folder):
            place = record["swath"]
            image = numpy.array(pillow.open(folder / record["split"] / record["image"])).astype(float)
            influence = picture_of(folder, record, "influence") > 0
            before = cut_of(swath, record)
            truth = truth_of(folder, record)
            if form == "lossless":
                assert record["image"].endswith(".png") and "jpeg_quality" not in truth
            else:
                assert record["image"].endswith(".jpg") and truth["jpeg_quality"] == quality
                assert place["row"] % 8 == 0 and place["column"] % 8 == 0
                assert place["row"] >= 3 and (place["row"] >= 11 or place["column"] + CHIP <= 98 or place["column"] >= 152)
            blocks = [(-place["row"] % 8 + 8 * i, -place["column"] % 8 + 8 * j) for i in range(7) for j in range(7)]
            cut = [(block, image[block[0] : block[0] + 8, block[1] : block[1] + 8],
                    influence[block[0] : block[0] + 8, block[1] : block[1] + 8]) for block in blocks]
            # blocks that the range of grey levels clips do not count
            inside = [block for block, part, changed in cut if changed.all() and 0 < part.min() and part.max() < 255]
            outside = [block for block, _, changed in cut if not changed.any()]
            found["input"] += coded_shares(before, blocks, table)
            found["injected"] += coded_shares(image, inside, table)
            found["left"] += [numpy.abs(image - before)[row : row + 8, column : column + 8].mean() for row, column in outside]
        shares[form] = found
        # rounding twice may move a pixel by one
        assert numpy.mean(found["left"]) < (0.1 if form == "as_input" else 1e-9)
    assert len(shares["as_input"]["injected"]) > 20
    assert numpy.mean(shares["as_input"]["input"]) > 0.99
    assert numpy.mean(shares["as_input"]["injected"]) > 0.99
    assert numpy.mean(shares["lossless"]["injected"]) < 0.5
    head = json.loads((ground / f"as_input{quality}" / "campaign.json").read_text())
    assert head["swaths"][0]["jpeg_quality"] == quality
    card = json.loads((ground / f"as_input{quality}" / "croissant.json").read_text())
    assert "image/jpeg" in [entry["encodingFormat"] for entry in card["distribution"]]


@pytest.mark.parametrize("settings, place", [
    (["chip.columns=all"], {"column": 8, "columns": 240 - 3 - 8}),
    (["chip.rows=all", "chip.columns=all", "swaths[0].set={input.geometry.nadir_column: 100, input.geometry.side: starboard, "
      "input.geometry.first_slant_range: 0 m, sonar.altitude: 0.5 m}"],
     {"row": 8, "rows": 200 - 3 - 8, "column": 104, "columns": 240 - 3 - 104})])
def test_images_of_all_of_a_jpeg_begin_where_its_blocks_do(ground, made, settings, place):
    pillow = pytest.importorskip("PIL.Image")
    levels = numpy.random.default_rng(20261127).rayleigh(40, (200, 240))
    pillow.fromarray(levels.clip(1, 255).astype("u1")).save(ground / "lines.jpg", quality=60)
    folder = made(f"lines{len(settings)}", "format=as_input", "swaths=[{path: lines.jpg}]", "splits={all: 1}", "images=2",
                  "chip.edge=3", *settings)
    for record in records(folder):
        assert record["swath"]["row"] % 8 == 0 and place.items() <= record["swath"].items()
        image = numpy.array(pillow.open(folder / record["split"] / record["image"]))
        assert image.shape == (record["swath"]["rows"], record["swath"]["columns"])


def test_a_value_may_be_a_ratio_of_another(made):
    """The value takes the other one's unit. A ratio may refer to a ratio."""
    body = ("targets=[{class: box, object: {shape: box}, draw: {length: {uniform: [40 cm, 80 cm]}, "
            "width: {of: length, uniform: [0.3, 0.6]}, height: {of: width, log_uniform: [0.5, 1]}}}]")
    for record in records(made("ratio", body, "empty=0")):
        length, width, height = (drawn_of(record)[f"objects[0].{key}"].split() for key in ("length", "width", "height"))
        assert length[1] == width[1] == height[1] == "cm"
        assert 0.3 <= float(width[0]) / float(length[0]) <= 0.6
        assert 0.5 <= float(height[0]) / float(width[0]) <= 1


BODIES = """\
# three bodies
shape,length [m],width,height [cm],heading,count
box,0.6,40 cm,30,,1
ellipsoid,0.5,0.3 m,20,30 deg,2
wedge,0.8,0.5 m,,,1 # its height is the object's
"""
TABLE = ["targets=[{class: body, object: {height: 25 cm}, draw: {table: {file: bodies.csv, weight: count}, "
         "burial: {of: length, uniform: [0.01, 0.05]}}}]",
         "empty=0", "clutter.alone=0", "images=8", "splits={all: 1}", "clutter.number=0", "outputs=[]"]


def test_a_row_of_a_table_is_drawn_whole(ground, command, made):
    """A row is drawn as often as its weight says. Empty cells keep the object's values. Columns replace common draws."""
    (ground / "bodies.csv").write_text(BODIES)
    settings = [*TABLE, 'draw={"objects[].heading": 77 deg}']
    rows = {"box": {"shape": "box", "length": "0.6 m", "width": "40 cm", "height": "30 cm"},
            "ellipsoid": {"shape": "ellipsoid", "length": "0.5 m", "width": "0.3 m", "height": "20 cm",
                          "heading": "30 deg"},
            "wedge": {"shape": "wedge", "length": "0.8 m", "width": "0.5 m"}}
    shapes = []
    for record in records(made("bodies", *settings)):
        mine = {key[11:]: value for key, value in drawn_of(record).items() if key.startswith("objects[0].")}
        burial = mine.pop("burial").split()
        assert mine == rows[mine["shape"]]
        assert burial[1] == "m" and 0.01 <= float(burial[0]) / float(mine["length"].split()[0]) <= 0.05
        shapes.append(mine["shape"])
    assert {shape: shapes.count(shape) for shape in rows} == {"box": 2, "ellipsoid": 4, "wedge": 2}
    (ground / "bodies.csv").write_text(BODIES.replace("0.8", "0.9"))
    answer = command("campaign", "campaign.yaml", "-o", "bodies", *sets(*settings))
    assert_refused(answer, 2, "differs in the table of targets[0]")


@pytest.mark.parametrize("design", ["stratified", "grid"])
def test_what_an_object_states_is_not_drawn_for_all(ground, command, design):
    """Also where the draw of all is of a part of it, as burial.fraction is of burial."""
    for fixed, drawn, key, value in (
            ("heading: 30 deg", "heading: {uniform: [60 deg, 90 deg]}", ("pose", "heading_deg"), 30),
            ("level: {over_seabed: 9 dB}", "level.over_seabed: {uniform: [12 dB, 14 dB]}", ("level", "asked_db"), 9),
            ("burial: 2 cm", "burial.fraction: {uniform: [0.5, 0.6]}", ("burial_m",), 0.02)):
        draw = f'draw={{"objects[].{drawn.replace(": {", chr(34) + ": {", 1)}}}'
        if design == "grid":
            draw = draw.replace("]}", "], steps: 100}")  # more steps than images, if they counted
        done = command("campaign", "campaign.yaml", "-o", f"{design} {key[0]}", "--set", "images=4", "--set", "empty=0",
                       "--set", "clutter.alone=0", "--set", "clutter.number=0", "--set", f"design={design}", "--set", draw,
                       "--set", f"targets=[{{class: box, object: {{shape: box, length: 40 cm, width: 30 cm, height: 20 cm, {fixed}}}}}]")
        assert done.returncode == 0, done.stderr
        truths = list((ground / f"{design} {key[0]}").glob("*/truth/*.json"))
        assert len(truths) == 4
        for path in truths:
            told = json.loads(path.read_text())["objects"][0]
            for part in key:
                told = told[part]
            assert told == pytest.approx(value)


@pytest.mark.parametrize("old, new, where, what", [
    ("20,", "20 stone,", "bodies.csv:4:21: objects[0].height", "'stone cm' is not one of"),
    ("width,", "widht,", "bodies.csv:2:18: widht", "did you mean 'width'?"),
    ("width,", "length,", "bodies.csv:2:18: length", "two columns"),
    ("heading,", "class,", "bodies.csv:2:36: class", "the campaign itself sets class"),
    ("heading,", "burial,", "targets[0].draw.burial", "is a column of the table, too"),
    ("[cm]", "[cm", "bodies.csv:2:24: height", "without a closing ]"),
    ("30 deg,2", "30 deg,-2", "bodies.csv:4:31: count", "'-2' is not a number"),
    ("count", "name", "bodies.csv:2:1: count", "no column has this name"),
    (",1 #", " #", "bodies.csv:5: ", "has 5 columns, but 6"),
    (BODIES, "length\n", "bodies.csv", "there are no rows"),
    (BODIES, "", "bodies.csv", "there is nothing in it"),
])
def test_mistakes_of_tables_have_a_place(ground, command, old, new, where, what):
    assert BODIES.count(old) == 1
    (ground / "bodies.csv").write_text(BODIES.replace(old, new))
    settings = [text.replace(", weight: count", "") if new == "length\n" else text for text in TABLE]
    assert_refused(command("campaign", "campaign.yaml", "-o", "hostile", *sets(*settings)), 3, where, what)
    assert not (ground / "hostile").exists()


def test_two_campaigns_in_one_folder_make_one_data_set(ground, environment, whole):
    arguments = [COMMAND, "campaign", "campaign.yaml", "-o", "twice", "--quiet"]
    both = [subprocess.Popen(arguments, cwd=ground, env=environment, stderr=subprocess.PIPE)
            for _ in range(2)]
    assert [(each.communicate()[1], each.returncode) for each in both] == [(b"", 0)] * 2
    assert contents(ground / "twice") == contents(whole)


SMALL = ["images=8", "chip.rows=32", "chip.columns=32", "outputs=[]", "empty=0", "targets[0].weight=0", "splits={all: 1}"]


def test_a_grid_draws_every_cell(command, ground):
    settings = sets(*SMALL, "design=grid", "draw={sonar.bandwidth: {choice: [30 kHz, 29 kHz]}}",
                    "targets[1].draw.heading={uniform: [0 deg, 90 deg], steps: 4}")
    assert command("campaign", "campaign.yaml", "-o", "grid", *settings, "--shard", "1/1").returncode == 0
    drawn = [drawn_of(record) for record in records(ground / "grid")]
    cells = {(each["sonar.bandwidth"], each["objects[0].heading"]) for each in drawn}
    assert cells == {(bandwidth, f"{heading} deg") for bandwidth in ("30 kHz", "29 kHz")
                     for heading in (0, 30, 60, 90)}


def test_a_random_design_draws_each_key_by_itself(made):
    drawn = [drawn_of(record) for record in records(made(
        "random", *SMALL, "design=random",
        "draw={sonar.altitude: {uniform: [10 m, 11 m]}, seabed.lambert: {uniform: [-30 dB, -29 dB]}}"))]
    shares = [(float(each["sonar.altitude"].split()[0]) - 10,
               float(each["seabed.lambert"].split()[0]) + 30) for each in drawn]
    assert all(abs(one - other) > 1e-4 for one, other in shares)
    assert len(set(shares)) == 8
    # in strata, each eighth would have one value
    assert all(len({int(8 * share) for share in of_key}) < 8 for of_key in zip(*shares))


def test_the_example_runs_as_it_says(ground, environment):
    """Makes every twentieth image of the example."""
    seabeds, campaign = comment_commands("tools/campaigns/minefield.yaml")
    (ground / "tools").symlink_to(SOURCE / "tools")
    (ground / "sonject").symlink_to(COMMAND)
    answer = subprocess.run(["bash", "-euc", f"{seabeds}; {campaign} --shard 2/20"], cwd=ground,
                            env={**environment, "PATH": f"{ground}:{environment['PATH']}"},
                            capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert answer.stderr.endswith("sonject: these images are in minefield\n")
    assert sorted(record["id"] for record in records(ground / "minefield")) == [1, 21, 41]


# Largest number of targets in an image, and smallest and largest length in the table, m.
STARTS = {"bottom_mines": (1, 0.98, 3.25), "uxo": (1, 0.24, 2.22), "drums": (3, 0.585, 0.88), "crab_pots": (1, 0.9, 1.24),
          "tyres": (1, 0.55, 1.04), "boulders": (7, 0.26, 1.8), "wreck_debris": (4, 0.5, 6)}


@pytest.mark.parametrize("start", STARTS)
def test_starting_campaigns_run_as_they_say(ground, environment, start):
    """Starting campaigns are short, and targets have the sizes of their tables."""
    text = (SOURCE / "tools" / "campaigns" / f"{start}.yaml").read_text()
    assert text.count("\n") <= 80
    folder = ground / f"start_{start}"
    folder.mkdir()
    (folder / "tools").symlink_to(SOURCE / "tools")
    (folder / "sonject").symlink_to(COMMAND)
    seabed, campaign = comment_commands(f"tools/campaigns/{start}.yaml")
    answer = subprocess.run(["bash", "-euc", f"{seabed}; {campaign} --set images=6"], cwd=folder,
                            env={**environment, "PATH": f"{folder}:{environment['PATH']}"},
                            capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    (data,) = [path.parent for path in folder.glob("*/dataset.json")]
    most, shortest, longest = STARTS[start]
    found = records(data)
    targets = [record["targets"] for record in found]
    assert len(found) == 6 and max(targets) <= most and (max(targets) > 1) == (most > 1)
    assert targets.count(0) == 1  # the image that must be empty
    seabed = images.read_tiff(folder / "seabed.tif")
    for record in found:
        truths = truth_of(data, record)["objects"]
        changed = images.read_tiff(data / of_image(record, "images", ".tif")) != cut_of(seabed, record)
        changed = changed.reshape(*changed.shape[:2], -1).any(axis=2)
        # a boulder in the shadow of another is not drawn anew, and has no label
        targets = [truth for truth in truths[: record["targets"]]
                   if truth["visible"] or "otherwise: difficult" not in text]
        assert 4 * len(targets) >= 3 * record["targets"]
        for truth in targets:
            longer = max(truth["dimensions"].values())
            assert shortest - 1e-6 <= longer <= 1.05 * longest
            # target and shadow in the image are about as long along the track as the target
            box = truth["box"]
            assert truth["visible"] and 0 < box["length_m"] <= 1.2 * longer + 0.3
            assert changed[box["row"] : box["row"] + box["rows"], box["column"] : box["column"] + box["columns"]].mean() > 0.25
        seen = [annotation["object_id"] for annotation in record["annotations"]]
        assert set(seen) >= {truth["id"] for truth in targets}


HOSTILE = [
    (["images=1000000000000000000"], "images", "1...10000000"),
    (["images=0"], "images", "1...10000000"),
    (["draw.sonar.frequncy=3"], "draw", "section"),
    (["scene=nowhere.yaml"], "nowhere.yaml", "there is no such scene file"),
    (["swaths[1].path=nowhere.png"], "nowhere.png", "there is no"),
    (["swaths[1].path=campaign.yaml"], "campaign.yaml", "no format"),
    (['draw={seabed.lambert: {normal: {mean: 0, deviation: 1, minimum: 50, maximum: 60}}}'],
     "seabed.lambert", "draws nothing"),
    (['draw={sonar.altitude: {uniform: [-3 m, 3 m]}}'], "sonar.altitude", "altitude"),
    (["design=grid", 'draw={seabed.lambert: {uniform: [0.1, 0.2], steps: 1000000}, '
      'sonar.bandwidth: {uniform: [29 kHz, 30 kHz], steps: 1000000}, '
      'sonar.resolution: {uniform: [3 cm, 4 cm], steps: 1000000}, '
      'sonar.frequency: {uniform: [90 kHz, 91 kHz], steps: 1000000}}'], "grid", "more than"),
    (["chip.rows=200"], "swath0.png", "too few for images of 200 x 64"),
    (["swaths[0].avoid=[{row: 0, column: 0, rows: 1099511627776, columns: 1099511627776}]"],
     "swath0.png", "has no place for images"),
    (["chip.rows=all", "chip.columns=all",
      f"swaths[0].avoid=[{{row: 0, column: 0, rows: {ROWS}, columns: {COLUMNS}}}]"], "swath0.png",
     f"no place for objects in images of {ROWS} x {COLUMNS}"),
    (["swaths[0].avoid=[{along_track: [90 m, 95 m], slant_range: [40 m, 41 m]}]"], "swath0.png",
     "does not reach 90 to 95 m along the track and slant ranges of 40 to 41 m"),
    (["swaths[0].avoid=[{along_track: [2 m, 1 m], slant_range: [40 m, 41 m]}]"], "swaths[0].avoid[0].along_track",
     "begins at 2 m, which is not below its end, 1 m"),
    (["swaths[0].avoid=[{row: 2, column: 1, rows: 3}]"], "swaths[0].avoid[0]", "row and column and rows and columns; give one of these"),
    (["chip.slant_range=[60 m, 70 m]"], "swath0.png", "60 to 70 m"),
    (["chip.columns=all", "chip.range_over_altitude=[8, 9]"], "swath0.png", "8 to 9 times the sonar's altitude"),
    (["swaths[1].path=swath0.png", "swaths[2].path=swath0.png"], "too few for 2 splits", "swath"),
    (["swaths[1].path=swath0.png", "swaths[0].split=train", "swaths[1].split=test"],
     "shows the same seabed as swath0.png", "swath0.png"),
    (["swaths[2].path=swath0.png", "swaths[1].path=swath0.png", "chip.rows=48", "chip.columns=48"]
     + [f"swaths[{i}].set={{input.geometry.nadir_column: 75, input.geometry.side: {side}, "
        "input.geometry.first_slant_range: 0 m, input.geometry.column_spacing: 10 cm, sonar.altitude: 1 m}" for i, side in enumerate(("port", "starboard"))],
     "swaths", "1 different swaths are too few for 2 splits"),  # the third swath shows both sides
    (["swaths[0].split=vla"], "swaths[0].split", "train, test"),
    (["splits={train: 0.5}"], "splits", "add up to 0.5"),
    (["splits={train: 1, val: 0}"], "splits.val", "must be above 0 and at most 1; leave a split without images out"),
    (["draw={seabed.lambert: {choice: [" + "0.1, " * 20000 + "0.1]}}"], "campaign.yaml",
     "more than 20000 scenes"),
]


@pytest.mark.parametrize("changes, where, what", HOSTILE)
def test_bad_campaigns_are_refused_with_a_line(command, ground, changes, where, what):
    answer = command("campaign", "campaign.yaml", "-o", "hostile", *sets(*changes))
    assert_refused(answer, 3, where, what)
    assert not (ground / "hostile").exists()


@pytest.fixture(scope="module")
def lines(ground):
    """Writes one line as an XTF file and as a JSF file of two frequencies, and their scene."""
    numbers = numpy.random.default_rng(4)
    sides = [numbers.rayleigh(3000, (ROWS, COLUMNS)).clip(1, 30000).astype("<u2") for _ in range(2)]
    (ground / "line.xtf").write_bytes(recordings.xtf_bytes(*sides))
    (ground / "line.jsf").write_bytes(recordings.jsf_bytes(*sides, subsystems=(20, 21)))
    (ground / "line.yaml").write_text("sonject: 1\ninput: {geometry: from_file}\n"
                                       "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: from_file}\n")


def of_line(name, one, other, *more):
    swaths = ", ".join(f"{{path: {name}, set: {{input.channel: {channel}}}}}" for channel in (one, other))
    return ["scene=line.yaml", f"swaths=[{swaths}]", "images=6", "chip={rows: 48, columns: 48}", *more]


@pytest.mark.parametrize("name, one, other", [("line.xtf", "port", "starboard"), ("line.jsf", 0, 3)])
def test_the_sides_of_a_line_are_two_swaths(made, lines, name, one, other):
    folder = made(name.replace(".", "_"), *of_line(name, one, other))
    channels = {split: {text for record in records(folder) if record["split"] == split
                        for text in record["set"] if text.startswith("input.channel=")} for split in ("train", "test")}
    assert sorted(map(sorted, channels.values())) == [[f"input.channel={one}"], [f"input.channel={other}"]]
    assert [swath["side"] for swath in page_data(folder)["swaths"]] == ["port", "starboard"]


@pytest.mark.parametrize("name, one, other", [
    ("line.xtf", "port", "port"), ("line.xtf", "port", 1), ("line.jsf", 0, 2)])  # the same side, or its other frequency
def test_a_side_of_a_line_is_in_no_two_splits(command, lines, name, one, other):
    assert_refused(command("campaign", "campaign.yaml", "-o", "hostile", *sets(*of_line(name, one, other))), 3,
                   "1 different swaths are too few for 2 splits")
    asked = sets(*of_line(name, one, other, "swaths[0].split=train", "swaths[1].split=test"))
    assert_refused(command("campaign", "campaign.yaml", "-o", "hostile", *asked), 3, "shows the same seabed as line.", "split train")


MISTAKEN = """\
sonject_campaign: 2
scene: scene.yaml
images: -3
chip: {rows: 15, columns: 64}
empty: 1.5
outputs: [shadows]
labels: [yoolo]
splits: {../evil: 1}
swaths: [{path: swath0.png}, {split: train}]
draw:
  level: {over_seabed: 3 dB}
  "objects[1].pitch": 0
  seabed: {lambert: {uniform: [-30 dB, -20 dB]}}
  class: 3
  sonar.frequncy: 3
  objects[].headnig: 3
  patch.rows: 3
  seabed.lambert: {uniform: [-3 dB, -30 dB]}
  sonar.altitude: {uniform: [nan, 1]}
  sonar.frequency: {uniform: [-30 dB, 1]}
  sonar.bandwidth: {log_uniform: [-30 dB, -3 dB]}
  sonar.resolution: {unifrom: [3 cm, 4 cm]}
  injection.rays: {choice: [1, 2], weights: [0, 0]}
targets:
  - {class: '', object: {shape: sphere, diamter: 1 m}}
  - {class: ball, weight: 1, draw: {sonar.altitude: 3}}
clutter: {number: 51, objects: [{class: stone, object: {shape: sphere, diameter: 20 cm}}]}
"""
# The messages of MISTAKEN, in the order of its lines.
TOLD = [
    ("sonject_campaign", "must be 1"), ("images", "whole number"), ("chip.rows", "16...8192"),
    ("empty", "0...1"), ("outputs", "did you mean 'shadow'?"),
    ("labels[0]", "did you mean 'yolo'?"), ("splits", "names a folder"), ("swaths[1].path", "missing"),
    ("draw.level", "is a key of objects: write objects[].level"), ("draw.objects[1].pitch", "is a key of objects"),
    ("draw.seabed", "is a section"), ("draw.class", "scenes have no such key; there are sonject, band"),
    ("sonar.frequncy", "did you mean 'frequency'?"), ("headnig", "did you mean 'heading'?"),
    ("patch.rows", "the campaign itself"), ("seabed.lambert", "swap them"),
    ("sonar.altitude", "not a finite number"), ("sonar.frequency", "same unit"),
    ("sonar.bandwidth", "above 0"), ("sonar.resolution", "'uniform'"), ("weights", "all 0"),
    ("targets[0].class", "1 to"), ("diamter", "did you mean 'diameter'?"),
    ("targets[1].object", "missing"), ("targets[1].draw.sonar.altitude", "is a key of scenes"),
    ("clutter.number", "0 to 50"),
]


def test_all_mistakes_are_told_in_their_lines(command, ground):
    (ground / "mistaken.yaml").write_text(MISTAKEN)
    answer = command("campaign", "mistaken.yaml", "-o", "hostile")
    assert_refused(answer, 3, "mistaken.yaml:1:", mistakes=len(TOLD))
    for line, (where, what) in zip(answer.stderr.splitlines(), TOLD):
        assert where in line and what in line, line
    assert not (ground / "hostile").exists()


def test_mistakes_have_a_place(command, ground):
    (ground / "typo.yaml").write_text(CAMPAIGN.replace("log_uniform: [0.4 m", "log_uniform: [4 m"))
    line = 1 + CAMPAIGN[: CAMPAIGN.index("log_uniform")].count("\n")
    answer = command("campaign", "typo.yaml", "-o", "hostile")
    assert_refused(answer, 3, f"typo.yaml:{line}:29: targets[1].draw.length.log_uniform: ")
    (ground / "typo.yaml").write_text(CAMPAIGN.replace("-24 dB]", "90 dB]"))
    line = 1 + CAMPAIGN[: CAMPAIGN.index("seabed.lambert")].count("\n")
    answer = command("campaign", "typo.yaml", "-o", "hostile")
    assert_refused(answer, 3, f"typo.yaml:{line}:", "seabed.lambert")
    written = "{shape: sphere, diameter: 0.3 m}"
    (ground / "typo.yaml").write_text(CAMPAIGN.replace(written, "{shape: sphere, fouling: {albedo: 3 m}}"))
    answer = command("campaign", "typo.yaml", "-o", "hostile")
    assert_refused(answer, 3, "typo.yaml:", "objects[0].fouling.albedo: unit 'm' is not one of dB")


def test_an_object_that_does_not_fit_is_told_by_its_key(command, ground):
    (ground / "proud.yaml").write_text(CAMPAIGN.replace(
        "{shape: sphere, diameter: 0.3 m}", "{shape: sphere, diameter: 0.3 m, burial: {proud: 9 m}}"
    ).replace("  objects[].burial: {uniform: [0 cm, 5 cm]}\n", ""))
    answer = command("campaign", "proud.yaml", "-o", "hostile")
    assert_refused(answer, 3, "objects[0].burial: ", "9.000 m proud")
    assert "--set" not in answer.stderr


@pytest.mark.parametrize("shard", ["0/2", "3/2", "1", "1/0", "/", "1/2/3", "-1/2"])
def test_odd_shards_are_usage(command, shard):
    assert_refused(command("campaign", "campaign.yaml", "-o", "hostile", f"--shard={shard}"), 2,
                   "--shard")
