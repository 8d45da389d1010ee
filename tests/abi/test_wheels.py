"""Tests of a release's wheels, made by tools/wheels.sh: needed libraries, licences, and the bits of results."""
import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

import pytest

import windows_python
from test_installed import BUILD, MODULES, needed_by
from test_interface import SOURCE
from test_release import VERSION, assert_sums, make_clone, release

COMMAND = BUILD / "tools" / "sonject"
OF_GLIBC = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
OF_WINDOWS = r"(?i)(kernel32|advapi32|shell32|ole32|user32|ntdll|api-ms-win-[a-z0-9-]+)\.dll"
SOURCES = {"zlib", "libyaml", "jansson", "expat", "xxhash", "libpng1.6", "libjpeg-turbo", "tiff", "zig"}
BYTES_MAX = 15_000_000
GLIBC = (2, 28)


@functools.cache  # pytest makes a fixture again after tests for another machine
def build(machine):
    """Makes a release with this machine's wheel alone and returns the wheel."""
    clone = SOURCE / "build-wheels" / machine
    shutil.rmtree(clone, ignore_errors=True)
    answer = release(make_clone(clone), f"v{VERSION}", machine)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    folder = pathlib.Path(answer.stdout.splitlines()[-1])
    assert_sums(folder)
    (found,) = folder.glob("*.whl")
    assert re.fullmatch(rf"sonject-{VERSION}-py3-none-.*{machine}\.whl", found.name)
    assert (folder / f"sonject-{VERSION}.tar.gz").exists() and len(list(folder.iterdir())) == 3
    return found


@pytest.fixture(scope="module", params=["x86_64", "aarch64", "win_amd64"])
def wheel(request):
    return build(request.param)


def is_of_windows(wheel):
    return wheel.stem.endswith("win_amd64")


@pytest.fixture(scope="module")
def unpacked(wheel, tmp_path_factory):
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture(scope="module")
def programs(wheel, unpacked):
    names = ("libsonject.dll", "sonject.exe", "sonject-decoder.exe") if is_of_windows(wheel) else (
        "libsonject.so", "sonject", "sonject-decoder")
    for name in names[1:]:
        (unpacked / "sonject" / name).chmod(0o755)
    return [unpacked / "sonject" / name for name in names]


@pytest.fixture(scope="module")
def under_wine(tmp_path_factory):
    """Returns a function that makes a script, which starts a Windows program."""
    folder = tmp_path_factory.mktemp("wine")

    def make(program):
        script = folder / program.stem
        script.write_text(f'#!/bin/sh\nWINEDEBUG=-all WINEPREFIX={folder / "prefix"} exec wine {program} "$@"\n', encoding="utf-8")
        script.chmod(0o755)
        # Wine's first start prints its setup, and Python under Wine starts with pipes alone.
        subprocess.run([script, "--version"], check=True, input=b"", capture_output=True)
        return script

    return make


@pytest.fixture(scope="module")
def command(wheel, programs, under_wine):
    """Returns the words that start the wheel's command here."""
    if wheel.stem.endswith("aarch64"):
        # With Debian's arm64 libraries. With -L, the loader is of the cross compiler's glibc and the rest of Debian's.
        return [shutil.which("qemu-aarch64"), programs[1]]
    if not is_of_windows(wheel):
        return [programs[1]]
    return [under_wine(programs[1])]


def test_a_wheel_holds_package_programs_examples_and_licences(wheel, unpacked):
    assert wheel.stat().st_size < BYTES_MAX
    assert MODULES <= {str(path.relative_to(unpacked)) for path in unpacked.rglob("*")}
    assert {path.stem for path in (unpacked / f"sonject-{VERSION}.dist-info" / "licenses").iterdir()} >= SOURCES
    examples = unpacked / f"sonject-{VERSION}.data" / "data" / "share" / "sonject"
    for folder in ("campaigns", "scenes", "targets"):
        assert {path.name for path in (examples / folder).iterdir()} == {
            path.name for path in (SOURCE / "tools" / folder).iterdir()}


def test_its_programs_need_the_system_alone(wheel, programs):
    """The programs need only an old glibc, or libraries that Windows has."""
    for program in programs:
        if is_of_windows(wheel):
            listing = subprocess.run(["objdump", "-p", program], check=True, capture_output=True, text=True).stdout
            needed = set(re.findall(r"DLL Name: (\S+)", listing))
            assert needed and not [name for name in needed - {"libsonject.dll"} if not re.fullmatch(OF_WINDOWS, name)]
            continue
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


def test_its_command_gives_the_bits_of_the_build(wheel, command, demo, tmp_path):
    """The command runs on the best instruction set of this processor, or under qemu."""
    if not wheel.stem.endswith("aarch64"):
        drivers = [subprocess.run([one, "devices"], check=True, capture_output=True, text=True).stdout.splitlines()[1]
                   for one in (COMMAND, *command)]
        assert drivers[0] == drivers[1]
    assert run_demo(command, tmp_path / "result") == demo


FROZEN = SOURCE / "tests" / "frozen"


@pytest.mark.parametrize("wheel", ["win_amd64"], indirect=True)
def test_windows_gives_the_builds_files(command, tmp_path):
    """Compares the files of all frozen scenes without HDF5. Messages have other line ends.
    Colours of pictures and bent rays come from the C library's own logarithms and cosines. Bent rays
    may change one byte in ten thousand."""
    scenes = set(re.findall(r"^\[(\w+)\]", (FROZEN / "scenes.txt").read_text(encoding="utf-8"), re.M))
    answer = subprocess.run([sys.executable, FROZEN / "outputs.py", COMMAND, *command, "--keep", tmp_path / "kept", "--scenes",
                             ",".join(sorted(scenes - {"convert", "formats"}))],
                            check=False, capture_output=True, text=True)
    lines = answer.stdout.splitlines()
    assert re.fullmatch(r"\d+ of \d+ lines differ", lines[-1])
    for line in lines[:-1]:
        kind, name = line.split()
        one, other = ((tmp_path / "kept" / which / name).read_bytes() for which in "12")
        if name.endswith(".messages"):
            assert one == other.replace(b"\r\n", b"\n"), name
        elif name.endswith(".png") or name.startswith("water/cast/"):
            assert name.endswith("quicklook.png") or (len(one) == len(other) and sum(
                a != b for a, b in zip(one, other)) < len(one) / 10_000), name
        else:
            assert kind == "encoding" or name.endswith("croissant.json"), line


@pytest.mark.parametrize("wheel", ["win_amd64"], indirect=True)
def test_windows_takes_any_name_and_replaces_files(command, tmp_path):
    folder = tmp_path / "s\u00f8n \u76ee"
    folder.mkdir()
    shutil.copy(SOURCE / "tools" / "scenes" / "demo.yaml", folder / "sc\u00e8ne.yaml")

    def run(scene, result, *options, code=0):
        answer = subprocess.run([*command, "run", scene, "-o", result, *options], cwd=folder, check=False,
                                capture_output=True)
        assert answer.returncode == code, answer.stderr
        return answer.stderr.decode("utf-8")

    run("sc\u00e8ne.yaml", "r\u00e9sultat")
    before = (folder / "r\u00e9sultat" / "image.tif").read_bytes()
    assert "injection.seed (1 there, 5 here)" in run("sc\u00e8ne.yaml", "r\u00e9sultat", "--set", "injection.seed=5", code=2)
    run("sc\u00e8ne.yaml", "r\u00e9sultat", "--set", "injection.seed=5", "--overwrite")
    assert (folder / "r\u00e9sultat" / "image.tif").read_bytes() != before
    lines = (folder / "sc\u00e8ne.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
    begin = lines.index("input:\n")
    end = next(i for i in range(begin + 1, len(lines)) if lines[i][0] not in " #\n")
    (folder / "again.yaml").write_text("".join([
        *lines[:begin], "input:\n  path: r\u00e9sultat\\image.tif\n  transfer: {kind: amplitude}\n"
        "  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 44 m}\n", *lines[end:]]), encoding="utf-8")
    run("again.yaml", "zwei")
    assert (folder / "zwei" / "image.tif").exists()
    (folder / "cut.tif").write_bytes(before[:3000])
    answer = subprocess.run([*command, "measure", "cut.tif"], cwd=folder, check=False, capture_output=True)
    assert answer.returncode == 3 and b"damaged TIFF" in answer.stderr


@pytest.mark.parametrize("wheel", ["win_amd64"], indirect=True)
def test_windows_passes_the_unit_tests(wheel, tmp_path):
    """Builds the unit tests as the wheel was built. One is left out: it calls complex functions."""
    place = next((SOURCE / "build-wheels" / "win_amd64").rglob("toolchain.cmake")).parent
    work = place.parent

    def call(*words, **more):
        answer = subprocess.run(words, check=False, stdin=subprocess.DEVNULL, capture_output=True, text=True, **more)
        assert answer.returncode == 0, answer.stdout + answer.stderr
        return answer.stdout

    call("apt-get", "-q", "source", "cmocka", cwd=tmp_path, env={**os.environ, "APT_CONFIG": str(work / "apt" / "conf")})
    (source,) = tmp_path.glob("cmocka-*")
    call("cmake", "-S", source, "-B", tmp_path / "cmocka", "-G", "Ninja", f"-DCMAKE_TOOLCHAIN_FILE={place / 'toolchain.cmake'}",
         f"-DCMAKE_INSTALL_PREFIX={place / 'prefix'}", "-DCMAKE_BUILD_TYPE=Release", "-DWITH_STATIC_LIB=ON", "-DWITH_EXAMPLES=OFF")
    call("ninja", "-C", tmp_path / "cmocka", "install")
    library = place / "prefix" / "lib" / "libcmocka-static.a"
    library.rename(library.with_name("libcmocka.a"))
    library.with_name("libcmocka.dll.a").unlink()
    (tmp_path / "wine.ini").write_text("[binaries]\nexe_wrapper = 'wine'\n", encoding="utf-8")
    wine = {**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(tmp_path / "prefix")}
    call("wine", "cmd", "/c", "exit", env=wine)  # its first start makes the prefix
    meson = work / "env" / "bin" / "meson"
    build = tmp_path / "build"
    call(meson, "setup", build, SOURCE, "--cross-file", place / "cross.ini", "--cross-file", tmp_path / "wine.ini",
         "-Dtests=enabled", "-Dhdf5=disabled", "-Dstatic=disabled")
    programs = (line.split(":")[0] for line in call("ninja", "-C", build, "-t", "targets", "all").splitlines()
                if re.match(r"tests/unit/[^:]*: [a-z]+_LINKER", line))
    call("ninja", "-C", build, *programs)
    names = [line.split(":")[-1].strip() for line in call(meson, "test", "-C", build, "--list", "--suite", "unit").splitlines()
             if "unit" in line]
    assert len(names) >= 38
    call(meson, "test", "-C", build, "--no-rebuild", "--print-errorlogs", *(set(names) - {"sediment"}), env=wine)


TESTS = SOURCE / "bindings" / "python" / "tests"
VARIABLES = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "SONJECT_READERS")}


def run_tests_of_python(python, library, *left_out):
    """Runs the bindings' tests but for those that need more than NumPy and those left out."""
    others = (f"{TESTS.relative_to(SOURCE)}/test_{name}.py" for name in ("torch", "notebooks_run", "train_detector"))
    answer = subprocess.run([*python, "-m", "pytest", "-q", "-p", "no:cacheprovider", TESTS.relative_to(SOURCE),
                             *(f"--ignore={path}" for path in others), *left_out], cwd=SOURCE,
                            env={**VARIABLES, "SONJECT_LIBRARY": str(library), "SONJECT_HAS_HDF5": "0"},
                            check=False, input="", capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr


@pytest.mark.parametrize("wheel", [os.uname().machine], indirect=True)
def test_python_passes_its_tests_with_it(wheel, tmp_path):
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "env"], check=True)
    python = tmp_path / "env" / "bin" / "python"
    subprocess.run([python, "-m", "pip", "-q", "install", wheel, "pytest", "pillow"], check=True)
    (library,) = (tmp_path / "env").rglob("libsonject.so")
    run_tests_of_python([python], library)
    version = subprocess.run([tmp_path / "env" / "bin" / "sonject", "--version"], env=VARIABLES, check=True,
                             capture_output=True, text=True)
    assert VERSION in version.stdout


@pytest.mark.parametrize("wheel", ["win_amd64"], indirect=True)
def test_python_on_windows_passes_its_tests_with_it(wheel, under_wine, tmp_path):
    """Three files are left out, and one test. Wine 8 ends a program that calls complex functions of C, as
    NumPy does for test_elements.py (and NumPy 2 always), and cannot start workers. The layout needs a
    compiler, the log PoCL."""
    zig = next((SOURCE / "build-wheels" / "win_amd64").rglob("ziglang/zig"))
    (tmp_path / "python").mkdir()
    program = windows_python.make(tmp_path / "python", zig, [wheel, "numpy<2", "pytest", "pillow", "colorama"])
    (library,) = (tmp_path / "python").rglob("libsonject.dll")
    run_tests_of_python(
        [under_wine(program)], f"Z:{library}",
        *(f"--ignore={TESTS.relative_to(SOURCE)}/test_{name}.py" for name in ("data_loader", "elements", "interface_layout")),
        "-k", "not test_the_log_tells_device_programs")
