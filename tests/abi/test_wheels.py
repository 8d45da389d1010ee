"""Wheels by tools/wheels.sh: that they need nothing, hold the licences, and give the build's bits."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

import pytest

from test_installed import BUILD, MODULES, needed_by
from test_interface import SOURCE

COMMAND = BUILD / "tools" / "sonject"
WHEELS = SOURCE / "build-wheels" / "wheels"
OF_GLIBC = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
SOURCES = {"zlib", "libyaml", "jansson", "expat", "xxhash", "libpng1.6", "libjpeg-turbo", "tiff", "zig"}
BYTES_MAX = 15_000_000
GLIBC = (2, 28)


@pytest.fixture(scope="module", params=["x86_64", "aarch64"])
def wheel(request):
    answer = subprocess.run([SOURCE / "tools" / "wheels.sh", request.param], check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    (found,) = WHEELS.glob(f"sonject-*-py3-none-manylinux_2_28_{request.param}.whl")
    return found


@pytest.fixture(scope="module")
def unpacked(wheel, tmp_path_factory):
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture(scope="module")
def programs(unpacked):
    return [unpacked / "sonject" / name for name in ("libsonject.so", "sonject", "sonject-decoder")]


def test_a_wheel_holds_package_programs_examples_and_licences(wheel, unpacked):
    assert wheel.stat().st_size < BYTES_MAX
    assert MODULES <= {str(path.relative_to(unpacked)) for path in unpacked.rglob("*")}
    assert {path.stem for path in (unpacked / "sonject-0.1.0.dist-info" / "licenses").iterdir()} >= SOURCES
    examples = unpacked / "sonject-0.1.0.data" / "data" / "share" / "sonject"
    for folder in ("campaigns", "scenes", "targets"):
        assert {path.name for path in (examples / folder).iterdir()} == {
            path.name for path in (SOURCE / "tools" / folder).iterdir()}


def test_its_programs_need_an_old_glibc_alone(programs):
    for program in programs:
        needed = set(re.findall(r"NEEDED.*\[(.*)\]", needed_by(program)))
        assert needed <= OF_GLIBC | {"libsonject.so"}, program
        symbols = subprocess.run(["readelf", "-W", "--dyn-syms", program], check=True, capture_output=True, text=True).stdout
        versions = {tuple(map(int, text.split("."))) for text in re.findall(r"@GLIBC_([\d.]+)", symbols)}
        assert versions and max(versions) <= GLIBC, program


def run_demo(command, folder):
    subprocess.run([*command, "run", SOURCE / "tools" / "scenes" / "demo.yaml", "-o", folder,
                    "--set", "injection.interactions=2"], check=True, stderr=subprocess.DEVNULL)
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != "run.json"}


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    return run_demo([COMMAND], tmp_path_factory.mktemp("demo") / "result")


def test_its_command_gives_the_bits_of_the_build(wheel, programs, demo, tmp_path):
    """On the best instruction set of this processor, or under qemu."""
    command = [programs[1]]
    for program in programs[1:]:
        program.chmod(0o755)
    if wheel.stem.endswith("aarch64"):
        command = [shutil.which("qemu-aarch64"), "-L", "/usr/aarch64-linux-gnu", *command]
    else:
        drivers = [subprocess.run([one, "devices"], check=True, capture_output=True, text=True).stdout.splitlines()[1]
                   for one in (COMMAND, *command)]
        assert drivers[0] == drivers[1]
    assert run_demo(command, tmp_path / "result") == demo


@pytest.mark.parametrize("wheel", [os.uname().machine], indirect=True)
def test_python_passes_its_tests_with_it(wheel, tmp_path):
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "env"], check=True)
    python = tmp_path / "env" / "bin" / "python"
    subprocess.run([python, "-m", "pip", "-q", "install", wheel, "pytest"], check=True)
    (library,) = (tmp_path / "env").rglob("libsonject.so")
    variables = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "SONJECT_READERS")}
    tests = SOURCE / "bindings" / "python" / "tests"
    answer = subprocess.run([python, "-m", "pytest", "-q", "-p", "no:cacheprovider", tests, "--ignore", tests / "test_torch.py"],
                            env={**variables, "SONJECT_LIBRARY": str(library), "SONJECT_HAS_HDF5": "0"},
                            check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout
    version = subprocess.run([tmp_path / "env" / "bin" / "sonject", "--version"], env=variables, check=True,
                             capture_output=True, text=True)
    assert "0.1.0" in version.stdout
