"""sonject fit: a campaign moves towards the contacts that it is given, and says what it did."""

import pytest

from conftest import page_data
import fitting


# So rough that targets have no glints, whose rays would be nine tenths of all work. The nightly
# fit_closed_loop has them.
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
    # it is the user's own file, comments and all, with other numbers
    assert [line.split("#")[1] for line in start.splitlines() if "#" in line] == [
        line.split("#")[1] for line in text.splitlines()[1:] if "#" in line]
    assert text.startswith("# Fitted by sonject")
    for name in ("start", "fitted"):
        sonject.done("campaign", f"{name}.yaml", "-o", f"as_{name}", "--set", "images=60", "--quiet")
    hidden, before, after = (fitting.drawn(folder / name) for name in ("contacts", "as_start", "as_fitted"))
    print(hidden, before, after)
    for kind in range(5):
        assert abs(after[kind] - hidden[kind]) < abs(before[kind] - hidden[kind])
    # 30 contacts tell sizes to some 15 %, levels to 2 dB: no such median was off by more
    assert all(abs(after[:3] / hidden[:3] - 1) < 0.3)
    assert all(abs(after[3:] - hidden[3:]) < 3)
    page = page_data(folder, "fitted.html")
    assert page["picture"] == "fitted.png" and (folder / "fitted.png").read_bytes().startswith(b"\x89PNG")
    assert "draw.objects[].heading\ndraw.objects[].burial.fraction" in page["unchanged"]
    (length,) = (draw for draw in page["draws"] if draw["key"] == "targets[0].draw.length")
    assert length["before"] == ["1.4 m", "3.2 m"]
    assert f"length: {{log_uniform: [{', '.join(length['after'])}]}}" in text
    for extent in page["fit"]:
        assert sum(extent["bins"]) > 0 and sum(extent["before"]) > 0 and sum(extent["after"]) > 0


@pytest.mark.parametrize("contacts, output, message", [
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "fitted.yaml",
     "contacts.csv: has 1 contacts; a fit needs 10 or more"),
    ("image,row,column,rows,columns\n" + "seabed_1.tif,295,5,9,20\n" * 10, "fitted.yaml",
     "seabed_1.tif: "),
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "start.yaml",
     "start.yaml: is the campaign that is fitted; choose another name"),
    ("image,row,column,rows,columns\nseabed_1.tif,5,5,9,20\n", "../{here}/start.yaml",
     "start.yaml: is the campaign that is fitted; choose another name"),
    # in the same folder by another name, so that what is wrong is the contacts
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


def test_range_that_grows_to_the_left_is_refused(sonject, folder):
    (folder / "contacts.csv").write_text("image,row,column,rows,columns\n" + "seabed_1.tif,5,5,9,20\n" * 10)
    text = (folder / "scene.yaml").read_text().replace("first_slant_range: 30 m", "first_slant_range: 0 m, "
                                                       "nadir_column: 480, side: port")
    (folder / "scene.yaml").write_text(text)
    done = sonject("fit", "start.yaml", "contacts.csv", "-o", "fitted.yaml")
    assert done.returncode == 3 and "seabed_1.tif: shows range growing to the left" in done.stderr
    assert not (folder / "fitted.yaml").exists()
