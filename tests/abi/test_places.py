"""Tests that frequent additions touch few places, by the examples in CONTRIBUTING.md."""
import os
import pathlib
import re
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
# The number of folders that a change touches, with the folder of its test; for a format, of files.
# lib/scene/params.h is not counted: a key's member is there for the purpose of the key.
PLACES = {"shape": 3, "key": 1, "format": 2, "material": 1, "pulse": 1, "verb": 1}


def shown_diff(what):
    text = (SOURCE / "CONTRIBUTING.md").read_text(encoding="utf-8")
    return re.search(rf"^## A new {what}\n.*?^```diff\n(.*?)^```", text, re.M | re.S)[1]


@pytest.mark.parametrize("what", PLACES)
def test_the_change_that_is_shown_fits_and_touches_few_places(what):
    diff = shown_diff(what)
    fits = subprocess.run(["git", "apply", "--check", "-"], cwd=SOURCE, check=False,
                          input=diff, text=True, capture_output=True)
    assert fits.returncode == 0, (
        f'"A new {what}": CONTRIBUTING.md\'s example no longer fits the code; move its hunk to '
        f"where it does:\n{fits.stderr}")
    files = set(re.findall(r"^\+\+\+ b/(\S+)", diff, re.M)) - {"lib/scene/params.h"}
    assert len(files if what == "format" else {name.rpartition("/")[0] for name in files}) \
        == PLACES[what]


def files_with(pattern):
    """Returns the files of code outside tests that match, as paths from the root."""
    return {str(path.relative_to(SOURCE)) for folder in ("kernels", "lib", "tools", "include")
            for path in (SOURCE / folder).rglob("*")
            if path.suffix in (".c", ".h", ".cl", ".cpp", ".build")
            and re.search(pattern, path.read_text(encoding="utf-8"))}


def rows(table, row=r"ROW\((\w+)"):
    return re.findall(rf"^ +{row}", (SOURCE / table).read_text(encoding="utf-8"), re.M)


def test_shapes_are_named_where_they_are_made():
    shapes = rows("kernels/shapes/shapes.h", r"ROW\((\w+), (\w+)")
    assert len(shapes) > 10
    for number, name in shapes:
        if name in ("sphere", "mesh", "user"):  # the default shape, and shapes without formulas
            continue
        named = files_with(rf"SHAPE_{number}\b|\bshape_{name}\b|\b{name}\.[ch]\b"
                           rf"|\b{name}_(interval|spans|normal)\b")
        assert {place.rpartition("/")[0] for place in named} <= {"kernels/shapes",
                                                                "lib/scene/shapes"}, name


def test_verbs_formats_and_materials_are_named_in_their_rows_and_files():
    for verb in rows("tools/verbs.h"):
        assert files_with(rf"\b{verb}_verb\b|tools/{verb}\.c\b") <= {f"tools/{verb}.c"}, verb
    for name in ("npy", "mat"):  # formats that no other format is based on
        assert name in rows("lib/swath/swath_format.h")
        assert files_with(rf"\b{name}_format\b|swath/{name}\.c\b") == {f"lib/swath/{name}.c"}
    materials = re.findall(r'^    \{"([a-z ]+)", \d', (SOURCE / "lib/schema/materials.c").read_text(
        encoding="utf-8"), re.M)
    assert len(materials) > 8
    for name in materials:
        assert files_with(f'"{name}"') == {"lib/schema/materials.c"}, name
