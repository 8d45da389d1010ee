"""Tests of further builds: the library without HDF5, the Python package by pip, tools/first-run.sh."""
import os
import pathlib
import shutil
import subprocess
import sys
import zipfile

import pytest

from test_installed import MODULES, needed_by
from test_interface import LIBRARY, SOURCE, exported_symbols
from test_release import VERSION

READERS = os.environ.get("SONJECT_READERS")
OPTIONS = ["-Dhdf5=disabled", "-Dtests=disabled", "-Dstatic=disabled", "-Dbuildtype=debug", "-Db_sanitize=none"]
# The call that pip makes of meson-python. It names a build folder outside the sources.
BUILD_WHEEL = """\
import sys, mesonpy
mesonpy.build_wheel(sys.argv[1], {"build-dir": sys.argv[2], "setup-args": sys.argv[3:]})
"""


def build_wheel(folder):
    answer = subprocess.run([READERS, "-c", BUILD_WHEEL, folder, folder / "build", *OPTIONS],
                            cwd=SOURCE, check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def build_library(folder):
    meson = shutil.which("meson")
    assert meson, "meson is needed to build the library"
    subprocess.run([meson, "setup", folder / "build", SOURCE, *OPTIONS], check=True,
                   capture_output=True)
    subprocess.run([meson, "compile", "-C", folder / "build", "sonject:shared_library"], check=True,
                   capture_output=True)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Builds in a new folder and returns it. pip's way is used if SONJECT_READERS names a Python that has
    meson-python."""
    folder = tmp_path_factory.mktemp("built")
    if READERS:
        build_wheel(folder)
    else:
        build_library(folder)
    return folder


@pytest.fixture(scope="module")
def library(built):
    return built / "build" / "lib" / "libsonject.so"


@pytest.fixture(scope="module")
def wheel(built):
    if not READERS:
        pytest.skip("SONJECT_READERS does not name a Python that has meson-python")
    (found,) = built.glob("*.whl")
    return found


@pytest.fixture
def installed(wheel, tmp_path):
    """Returns the folder of the package that pip installed."""
    subprocess.run([READERS, "-m", "pip", "-q", "install", "--no-index", "--no-deps", "--target",
                    tmp_path, wheel], check=True)
    return tmp_path


def test_the_library_needs_no_hdf5(library):
    assert "hdf5" in needed_by(LIBRARY) and "hdf5" not in needed_by(library)
    assert exported_symbols(library) == exported_symbols(LIBRARY)


def test_the_wheel_holds_package_and_library(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert {"sonject/scene.py", "sonject/py.typed"} <= MODULES
    examples = {name for name in names if "/share/sonject/" in name}
    assert names - examples == MODULES | {f"sonject/{name}" for name in ("libsonject.so", "sonject", "sonject-decoder")}
    for name in ("scenes/demo.yaml", "matlab/sonject.m"):
        assert any(each.endswith(f"share/sonject/{name}") for each in examples), name


def test_the_installed_package_finds_its_library(installed):
    program = """\
import pathlib, sonject
from sonject import _library
geometry = {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 40}
scene = sonject.Scene(sonar={"frequency": 1e5, "bandwidth": 3e4, "altitude": 10},
                      input={"geometry": geometry}, objects=[{"shape": "sphere", "diameter": 0.5}])
print(sonject.version(), scene.object_count, pathlib.Path(_library.load()._name).parent)
"""
    variables = {name: value for name, value in os.environ.items() if name != "SONJECT_LIBRARY"}
    answer = subprocess.run([READERS, "-c", program], cwd=installed, capture_output=True, text=True,
                            check=False, env={**variables, "PYTHONPATH": str(installed)})
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.split() == [VERSION, "1", str(installed / "sonject")]
    command = subprocess.run([installed / "sonject" / "sonject", "--version"], capture_output=True, text=True, check=True)
    assert VERSION in command.stdout


def test_the_first_command_builds_and_ends_with_the_path_of_a_picture(tmp_path):
    listed = subprocess.run(["git", "ls-files"], cwd=SOURCE, check=True, capture_output=True, text=True).stdout
    for name in listed.splitlines():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(SOURCE / name, tmp_path / name)
    answer = subprocess.run(["sh", "tools/first-run.sh"], cwd=tmp_path, check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    variables = {name: value for name, value in os.environ.items() if name != "SONJECT_LIBRARY"}
    variables["PYTHONPATH"] = str(tmp_path / "build" / "bindings" / "python")
    subprocess.run([sys.executable, "-c", "import sonject; sonject.version()"], env=variables, check=True)
    picture = pathlib.Path(answer.stdout.splitlines()[-1])
    assert picture.parent == tmp_path / "build" / "demo" and picture.read_bytes().startswith(b"\x89PNG")
