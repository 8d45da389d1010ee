"""The core alone: a library that loads no C++ runtime, and the Python package that pip makes of it."""
import os
import pathlib
import shutil
import subprocess
import zipfile

import pytest

from test_interface import LIBRARY, SOURCE, exported_symbols

READERS = os.environ.get("SONJECT_READERS")
PACKAGE = SOURCE / "bindings" / "python" / "sonject"
CORE = ["-Dopenimageio=disabled", "-Dassimp=disabled", "-Dhdf5=disabled", "-Dtests=disabled",
        "-Dstatic=disabled", "-Dbuildtype=debug", "-Db_sanitize=none"]
# What pip asks meson-python for. The build folder is said, so that none is made among the sources.
BUILD_WHEEL = """\
import sys, mesonpy
mesonpy.build_wheel(sys.argv[1], {"build-dir": sys.argv[2], "setup-args": sys.argv[3:]})
"""


def build_wheel(folder):
    if not READERS or subprocess.run([READERS, "-c", "import mesonpy"], capture_output=True,
                                     check=False).returncode != 0:
        return None
    subprocess.run([READERS, "-c", BUILD_WHEEL, folder, folder / "build", *CORE], cwd=SOURCE,
                   check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def build_library(folder):
    meson = shutil.which("meson")
    assert meson, "meson is needed to build the core"
    subprocess.run([meson, "setup", folder / "build", SOURCE, *CORE], check=True,
                   capture_output=True)
    subprocess.run([meson, "compile", "-C", folder / "build", "sonject:shared_library"], check=True,
                   capture_output=True)


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    """The library, and the wheel with it: None where PyPI was out of reach."""
    folder = tmp_path_factory.mktemp("core")
    wheel = build_wheel(folder)
    if not wheel:
        build_library(folder)
    return folder / "build" / "lib" / "libsonject.so", wheel


@pytest.fixture
def installed(core, tmp_path):
    """Where pip put the package."""
    if not core[1]:
        pytest.skip("SONJECT_READERS does not name a Python that has meson-python")
    subprocess.run([READERS, "-m", "pip", "-q", "install", "--no-index", "--no-deps", "--target",
                    tmp_path, core[1]], check=True)
    return tmp_path


def test_core_loads_no_cxx_runtime(core):
    needed = subprocess.run(["readelf", "-d", core[0]], check=True, capture_output=True,
                            text=True).stdout
    assert "NEEDED" in needed and "libstdc++" not in needed and "OpenImageIO" not in needed
    assert "hdf5" not in needed
    assert exported_symbols(core[0]) == exported_symbols(LIBRARY)


def test_the_wheel_holds_package_and_library(core):
    if not core[1]:
        pytest.skip("SONJECT_READERS does not name a Python that has meson-python")
    with zipfile.ZipFile(core[1]) as wheel:
        names = {name for name in wheel.namelist() if ".dist-info/" not in name}
    sources = {f"sonject/{path.relative_to(PACKAGE)}" for path in PACKAGE.rglob("*")
               if path.is_file() and "__pycache__" not in path.parts}
    assert {"sonject/_structures/__init__.py", "sonject/py.typed"} <= sources
    assert names == sources | {"sonject/libsonject.so"}


def test_the_installed_package_finds_its_library(installed):
    program = """\
import pathlib, sonject
from sonject import _library
scene = sonject.Scene(geometry=sonject.Geometry(first_slant_range_m=40.0),
                      objects=[sonject.Sphere(diameter_m=0.5)])
print(sonject.version(), scene.object_count, pathlib.Path(_library.load()._name).parent)
"""
    variables = {name: value for name, value in os.environ.items() if name != "SONJECT_LIBRARY"}
    answer = subprocess.run([READERS, "-c", program], cwd=installed, capture_output=True, text=True,
                            check=False, env={**variables, "PYTHONPATH": str(installed)})
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.split() == ["0.1.0", "1", str(installed / "sonject")]
