"""The core alone: a library that loads no C++ runtime, and the Python package that pip makes of it;
and what a package of the whole would hold."""
import json
import os
import pathlib
import shutil
import subprocess
import tomllib
import zipfile

import pytest

from test_installed import BUILD, MODULES
from test_interface import LIBRARY, SOURCE, exported_symbols

READERS = os.environ.get("SONJECT_READERS")
CORE = ["-Dopenimageio=disabled", "-Dhdf5=disabled", "-Dtests=disabled",
        "-Dstatic=disabled", "-Dbuildtype=debug", "-Db_sanitize=none"]
# What pip asks meson-python for. The build folder is said, so that none is made among the sources.
BUILD_WHEEL = """\
import sys, mesonpy
mesonpy.build_wheel(sys.argv[1], {"build-dir": sys.argv[2], "setup-args": sys.argv[3:]})
"""


def build_wheel(folder):
    answer = subprocess.run([READERS, "-c", BUILD_WHEEL, folder, folder / "build", *CORE],
                            cwd=SOURCE, check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def build_library(folder):
    meson = shutil.which("meson")
    assert meson, "meson is needed to build the core"
    subprocess.run([meson, "setup", folder / "build", SOURCE, *CORE], check=True,
                   capture_output=True)
    subprocess.run([meson, "compile", "-C", folder / "build", "sonject:shared_library"], check=True,
                   capture_output=True)


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    """The folder of its build: by pip, where SONJECT_READERS names a Python with meson-python."""
    folder = tmp_path_factory.mktemp("core")
    if READERS:
        build_wheel(folder)
    else:
        build_library(folder)
    return folder


@pytest.fixture(scope="module")
def library(core):
    return core / "build" / "lib" / "libsonject.so"


@pytest.fixture(scope="module")
def wheel(core):
    if not READERS:
        pytest.skip("SONJECT_READERS does not name a Python that has meson-python")
    (found,) = core.glob("*.whl")
    return found


@pytest.fixture
def installed(wheel, tmp_path):
    """Where pip put the package."""
    subprocess.run([READERS, "-m", "pip", "-q", "install", "--no-index", "--no-deps", "--target",
                    tmp_path, wheel], check=True)
    return tmp_path


def test_core_loads_no_cxx_runtime(library):
    needed = subprocess.run(["readelf", "-d", library], check=True, capture_output=True,
                            text=True).stdout
    assert "NEEDED" in needed and "libstdc++" not in needed and "OpenImageIO" not in needed
    assert "hdf5" not in needed
    assert exported_symbols(library) == exported_symbols(LIBRARY)


def test_the_wheel_holds_package_and_library(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert {"sonject/scene.py", "sonject/py.typed"} <= MODULES
    assert names == MODULES | {"sonject/libsonject.so", "sonject/sonject-decoder"}


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
    assert answer.stdout.split() == ["0.1.0", "1", str(installed / "sonject")]


def test_a_wheel_with_image_files_has_their_module(tmp_path):
    """By what meson would install; building it all again would show no more."""
    if not (BUILD / "lib" / "openimageio.so").exists():
        pytest.skip("built without image files")
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text(encoding="utf-8"))
    settings = project["tool"]["meson-python"]["args"]
    subprocess.run(["meson", "setup", tmp_path, SOURCE, *settings["setup"]], check=True,
                   capture_output=True)
    plan = json.loads((tmp_path / "meson-info" / "intro-install_plan.json").read_text())
    entries = [entry for kind in plan.values() for entry in kind.values()]
    assert settings["install"] == ["--tags=python-runtime"]
    assert {entry["destination"] for entry in entries if entry["tag"] == "python-runtime"} == {
        *(f"{{py_platlib}}/{name}" for name in MODULES), "{py_platlib}/sonject/libsonject.so",
        "{py_platlib}/sonject/openimageio.so", "{py_platlib}/sonject/tiff_png.so",
        "{py_platlib}/sonject/sonject-decoder"}
