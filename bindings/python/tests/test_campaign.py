"""Campaigns in memory and as files."""

import locale
import os
import pickle

import numpy
import pytest

import sonject
from conftest import CAMPAIGN_SCENE, GEOMETRY

@pytest.fixture
def campaign(campaign_folder):
    return sonject.Campaign(campaign_folder / "campaign.yaml"), numpy.load(campaign_folder / "swath.npy")


def test_images_are_made_in_memory_in_any_order(campaign):
    whole, swath = campaign
    assert len(whole) == 6 and repr(whole) == "<sonject.Campaign of 6 images>"
    assert whole.scene(0)._repr_html_() is None
    with pytest.raises(sonject.SonjectError, match="a campaign's scene has no text"):
        whole.scene(0)["sonar"]
    forward = [result.image for result in whole]
    backward = [whole[-1 - number].image for number in range(6)]
    for number in range(6):
        assert numpy.array_equal(forward[number], backward[5 - number])
        told = whole.describe(number)
        place = swath[told.first_row : told.first_row + 64, told.first_column : told.first_column + 64]
        assert (told.id, told.split, told.swath, told.rows, told.columns) == (number, "all", 0, 64, 64)
        assert numpy.array_equal(forward[number], place) == (told.object_count == 0)
        assert told.class_name == ("ball" if told.object_count else "")
    assert sum(whole.describe(number).object_count for number in range(6)) == 4
    with pytest.raises(IndexError):
        whole[6]
    with pytest.raises(TypeError):
        whole[1.0]


def test_loaders_may_pickle_a_campaign(campaign, tmp_path, monkeypatch):
    """Loaders may also number its images with NumPy's integers."""
    _, swath = campaign
    monkeypatch.chdir(tmp_path)
    written = pickle.dumps(sonject.Campaign("campaign.yaml", {"images": 3, "empty": 0}))
    monkeypatch.chdir("/")
    again = pickle.loads(written)
    assert len(again) == 3
    number = numpy.arange(3)[2]
    assert again.describe(number) == again.describe(-1)
    assert not numpy.array_equal(again[number].image, swath[:64, :64])


def test_the_working_directory_may_change(campaign, tmp_path, monkeypatch):
    whole, _ = campaign
    monkeypatch.chdir(tmp_path)
    again = sonject.Campaign("campaign.yaml")
    monkeypatch.chdir("/")
    assert numpy.array_equal(again[0].image, whole[0].image)


def test_the_scene_of_an_image_is_one_to_inject(campaign):
    whole, swath = campaign
    number = next(i for i in range(6) if whole.describe(i).object_count)
    told = whole.describe(number)
    scene = whole.scene(number)
    assert scene.object_count == 1
    truth = whole[number].objects[0]
    assert 64 * 0.35 - 1 <= truth.row <= 64 * 0.65 and truth.is_visible


@pytest.mark.parametrize("kind, curve", [
    ("uint8", "{kind: decibel, parameter: 0.378, offset: -80 dB}"),
    ("uint16", "{kind: amplitude}"),
    ("uint16", "{kind: gamma, parameter: 2, full_scale: 4095}"),
    ("float32", "{kind: intensity}"),
])
def test_images_in_memory_are_those_of_the_files(kind, curve, campaign_folder):
    """The scene has bright targets, which full scale cuts, and a row where nothing was heard."""
    transfer = sonject.Transfer(curve)
    swath = transfer.from_amplitude(2 * numpy.load(campaign_folder / "swath.npy"), kind)
    swath[40] = 0
    numpy.save(campaign_folder / "swath.npy", swath)
    (campaign_folder / "scene.yaml").write_text(
        CAMPAIGN_SCENE.replace("input:\n", f"input:\n  transfer: {curve}\n"))
    bright = {"draw": {"objects[].diameter": 0.3, "objects[].level.over_seabed": "30 dB"}}
    whole = sonject.Campaign(campaign_folder / "campaign.yaml", bright)
    whole.run(campaign_folder / "set")
    cut = 0
    for number, made in enumerate(whole):
        (path,) = (campaign_folder / "set" / "all" / "images").glob(f"{number:08}.*")
        sonject.convert(path, campaign_folder / f"{number}.npy")
        stored = numpy.load(campaign_folder / f"{number}.npy")
        assert stored.dtype == kind and made.image.dtype == numpy.float32
        assert numpy.array_equal(made.image, transfer.to_amplitude(stored))
        cut += made.statistics.output_clipped
    assert cut > 0 or kind == "float32"


def test_what_a_campaign_without_a_folder_lacks_is_made_by_one_with_a_folder(campaign_folder):
    """The message of images in memory says how."""
    numbers = numpy.random.default_rng(8)
    numpy.save(campaign_folder / "swath.npy", numbers.rayleigh(20, (300, 300)).astype(numpy.uint8))
    scene = campaign_folder / "scene.yaml"
    scene.write_text(CAMPAIGN_SCENE.replace("input:\n", "input:\n  calibration: auto\n"))
    whole = sonject.Campaign(campaign_folder / "campaign.yaml")
    with pytest.raises(sonject.SonjectError, match="image 4: .*sonject campaign --only 4 -o FOLDER, and name the file "
                                                   "FOLDER/calibrations/0.yaml") as caught:
        whole[4]
    assert "\n" not in str(caught.value)
    whole.run(campaign_folder / "set", only=4)
    scene.write_text(scene.read_text().replace("auto", "set/calibrations/0.yaml"))
    assert sonject.Campaign(campaign_folder / "campaign.yaml")[4].shape == (64, 64)


def test_what_did_not_fail_leaves_no_message(campaign, tmp_path):
    """An image may be seen too little, or be drawn again before it fits."""
    context = sonject.Context()
    for number, settings in enumerate([
            {"visible": {"highlight": "90 dB", "otherwise": "difficult"}},
            {"visible": {"highlight": "90 dB"}}, {"visible": {"highlight": "3 dB"}}]):
        made = sonject.Campaign(tmp_path / "campaign.yaml", {"images": 3, "empty": 0, **settings}, context=context)
        assert made.run(tmp_path / f"faint{number}")
        assert context._library.sonject_context_message(context._pointer) == b""


def in_each_locale(work):
    """Returns what work(name) returns in a host without and with a decimal comma."""
    made = []
    for name in ("C", "de_DE.UTF-8"):
        try:
            locale.setlocale(locale.LC_ALL, name)
        except locale.Error:
            pytest.skip("no locale with a decimal comma is installed")
        try:
            made.append(work(name))
        finally:
            locale.setlocale(locale.LC_ALL, "C")
    return made


def test_a_data_set_is_the_same_in_a_host_with_a_decimal_comma(campaign, tmp_path):
    """Records keep why targets were drawn again, and images their grey levels."""
    settings = {"images": 3, "empty": 0, "visible": {"highlight": "90 dB"}, "grey": ["-50.5 dB", "6.5 dB"]}
    in_each_locale(lambda name: sonject.Campaign(tmp_path / "campaign.yaml", settings).run(tmp_path / name))
    comma = tmp_path / "de_DE.UTF-8"
    files = [path.relative_to(comma) for path in comma.rglob("*.*") if path.name != "times.json"]
    assert "highlight" in (tmp_path / "C" / "all" / "records" / "00000000.json").read_text().split("because")[1]
    for path in files:
        assert (comma / path).read_bytes() == (tmp_path / "C" / path).read_bytes(), path


def test_a_check_is_the_same_in_a_host_with_a_decimal_comma(make_scene):
    scene = make_scene(input={"uniform": {"rows": 60, "columns": 90}, "geometry": GEOMETRY})
    point, comma = in_each_locale(lambda name: sonject.check(scene))
    assert point == comma and "m along-track" in point


@pytest.mark.parametrize("name", ["swath.npy", "target.yaml", "rock.obj", "pings.csv", "heights.npy"])
def test_files_that_were_changed_since_the_campaign_was_read_are_refused(campaign_folder, monkeypatch, name):
    """A change back is a change, too, since nobody knows what was read between."""
    monkeypatch.chdir(campaign_folder)
    (campaign_folder / "target.yaml").write_text("sonject_target: 1\nparts: [{name: rock, shape: mesh, mesh: {file: rock.obj}}]\n")
    (campaign_folder / "rock.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    (campaign_folder / "pings.csv").write_text("row,altitude_m\n0,10\n89,10\n")
    numpy.save("heights.npy", numpy.zeros((20, 20), numpy.float32))
    (campaign_folder / "scene.yaml").write_text(CAMPAIGN_SCENE + (
        "seabed: {relief: [{heights: {file: heights.npy, unit: m, row_spacing: 1, column_spacing: 1, first_ground_range: 18}}]}\n"))
    settings = {"targets": [{"class": "rock", "object": {"target": "target.yaml"}}], "draw": {},
                "swaths": [{"path": "swath.npy", "set": {"input.pings": "pings.csv", "sonar.altitude": "from_file"}}]}
    whole = sonject.Campaign(campaign_folder / "campaign.yaml", {**settings, "empty": 0})
    assert whole[0].image.any() and whole.scene(0).object_count == 1
    os.utime(campaign_folder / "campaign.yaml", ns=(1, 1))  # what was kept may change
    os.utime(campaign_folder / "scene.yaml", ns=(1, 1))
    assert whole[1].image.any()
    os.utime(campaign_folder / name, ns=(1, 1))
    message = f"{name}: was changed since the campaign was read"
    for work in (lambda: whole[2], lambda: whole.run(campaign_folder / "set"), lambda: whole.scene(3)):
        with pytest.raises(sonject.SonjectError, match=message):
            work()
    assert not [path for path in (campaign_folder / "set").rglob("*0000*")]
    again = sonject.Campaign(campaign_folder / "campaign.yaml", {**settings, "empty": 0})
    assert again.run(campaign_folder / "set")


def test_a_data_set_is_made_once(campaign, tmp_path):
    whole, _ = campaign
    seen = []
    for part in ((1, 2), (2, 2)):
        with pytest.raises(sonject.SonjectError):
            sonject.merge_campaign(tmp_path / "set")
        assert whole.run(tmp_path / "set", shard=part,
                         progress=lambda fraction, stage: seen.append(stage))
    sonject.merge_campaign(tmp_path / "set")
    fractions = []
    assert not whole.run(tmp_path / "set",
                         progress=lambda fraction, stage: fractions.append(fraction))
    assert all(0 <= fraction <= 1 for fraction in fractions)
    assert any(stage.endswith("images/s") for stage in seen)
    assert (tmp_path / "set" / "all" / "coco.json").exists()
    other = sonject.Campaign(tmp_path / "campaign.yaml", {"images": 5})
    with pytest.raises(sonject.SonjectError, match=r"differs in images \(6 there, 5 here\)"):
        other.run(tmp_path / "set")
    assert other.run(tmp_path / "set", overwrites=True)
    with pytest.raises(sonject.SonjectError, match="shard_index"):
        whole.run(tmp_path / "set", shard=(3, 2))
    with pytest.raises(ValueError, match="shard must lie within"):
        whole.run(tmp_path / "set", shard=(2**32 + 1, 2))


def test_a_data_set_stops_by_itself_and_one_image_is_made_alone(campaign, tmp_path):
    # More images than any machine makes at once.
    whole = sonject.Campaign(tmp_path / "campaign.yaml", {"images": 100})
    folder = tmp_path / "set"
    with pytest.raises(sonject.Cancelled):
        whole.run(folder, exit_after_s="0.001 us")
    made = {path.stem for path in folder.glob("all/records/*")}
    assert "00000000" in made and "00000099" not in made
    assert whole.run(folder, only=99)
    assert {path.stem for path in folder.glob("all/records/*")} == made | {"00000099"}
    assert not (folder / "all" / "coco.json").exists()
    with pytest.raises(sonject.SonjectError, match="not below 0"):
        whole.run(folder, exit_after_s=-1)


def test_mistakes_say_where(tmp_path, campaign):
    with pytest.raises(sonject.SonjectError, match="images: must be 1"):
        sonject.Campaign(tmp_path / "campaign.yaml", {"images": 10**18})


def test_a_campaign_is_fitted(tmp_path, campaign):
    """A whole fit is in tests/cli/test_fit.py; this one stops when its first contacts are made."""
    (tmp_path / "published.yaml").write_text(
        "contacts: 40\nquantiles: [0.1, 0.5, 0.9]\nhighlight_along: [20 cm, 30 cm, 40 cm]\n")
    files = [tmp_path / name for name in ("campaign.yaml", "published.yaml", "fitted.yaml")]
    seen = []

    def progress(fraction, stage):
        seen.append((fraction, stage))
        return fraction > 0.01

    with pytest.raises(sonject.SonjectError) as told:
        sonject.fit_campaign(*files, {"empty": 0.5}, boxes="highlight", progress=progress)
    assert told.value.status == sonject.Status.CANCELLED
    fractions, stages = zip(*seen)
    assert len(seen) > 1 and max(fractions) < 0.1 and not files[2].exists()
    assert len(set(stages)) == 1 and stages[0].startswith("round 1 of ")
    with pytest.raises(sonject.SonjectError, match="must lie in the folder of .*campaign.yaml"):
        sonject.fit_campaign(*files[:2], tmp_path / "there" / "fitted.yaml")


def test_contacts_of_classes_are_fitted(tmp_path, campaign):
    (tmp_path / "contacts.csv").write_text("image,row,column,rows,columns,class\n"
                                           + "swath.npy,50,50,9,20,mine\nnone.npy,50,50,9,20,boulder\n")
    files = [tmp_path / name for name in ("campaign.yaml", "contacts.csv", "fitted.yaml")]
    for classes in ("mine", ["mime", "mine"]):
        with pytest.raises(sonject.SonjectError, match="has 1 contacts"):
            sonject.fit_campaign(*files, classes=classes)


def test_a_fit_makes_the_calibrations_that_its_scene_asks_for(tmp_path, campaign):
    numbers = numpy.random.default_rng(8)
    for name in ("swath.npy", "other.npy"):
        numpy.save(tmp_path / name, numbers.rayleigh(20, (300, 300)).astype(numpy.uint8))
    (tmp_path / "scene.yaml").write_text(CAMPAIGN_SCENE.replace("input:\n", "input:\n  calibration: auto\n"))
    (tmp_path / "contacts.csv").write_text("image,row,column,rows,columns\n" + "other.npy,50,50,9,20\n"
                                           + "".join(f"swath.npy,{row},50,9,20\n" for row in range(50, 59)))
    with pytest.raises(sonject.SonjectError) as told:
        sonject.fit_campaign(tmp_path / "campaign.yaml", tmp_path / "contacts.csv", tmp_path / "fitted.yaml",
                             progress=lambda fraction, stage: fraction > 0.005)
    assert told.value.status == sonject.Status.CANCELLED
    made = sorted((tmp_path / "fitted_fit" / "calibrations").glob("*.yaml"))
    assert len(made) == 2 and made[0].name == "0.yaml"
    assert all("kind: amplitude" in path.read_text() for path in made)
