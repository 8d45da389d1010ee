"""Tests of the installed library: its files, and programs that find it by pkg-config and by CMake."""
import os
import pathlib
import re
import shutil
import subprocess

import numpy
import pytest

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
BUILD = pathlib.Path(os.environ["SONJECT_LIBRARY"]).resolve().parent.parent
CXX_COMPILER = os.environ.get("CXX", "c++")
EXAMPLE = SOURCE / "bindings" / "cxx" / "examples" / "train_on_the_fly.cpp"
PAGE = (SOURCE / "docs" / "embedding.md").read_text(encoding="utf-8")
PACKAGE = SOURCE / "bindings" / "python" / "sonject"
MODULES = {f"sonject/{path.name}" for path in PACKAGE.iterdir() if path.suffix in (".py", ".typed")}
MODULES |= {f"sonject/{name}.py" for name in ("_interface", "_classes", "enumerations", "keys")}  # generated
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """Installs the build and returns the folder for DESTDIR."""
    folder = tmp_path_factory.mktemp("root")
    subprocess.run(["meson", "install", "-C", BUILD, "--no-rebuild", "--quiet"], check=True,
                   env={**os.environ, "DESTDIR": str(folder)}, stdout=subprocess.DEVNULL)
    return folder


@pytest.fixture(scope="module")
def prefix(root):
    """Returns the prefix inside that folder. No file was configured for this prefix."""
    return next(root.rglob("sonject.hpp")).parent.parent


def pkg_config_flags(root):
    folder = next(root.rglob("sonject.pc")).parent
    variables = {**os.environ, "PKG_CONFIG_LIBDIR": str(folder),
                 "PKG_CONFIG_SYSROOT_DIR": str(root)}
    return subprocess.run(["pkg-config", "--cflags", "--libs", "sonject"], capture_output=True,
                          text=True, check=True, env=variables).stdout.split()


def pkg_config_static(prefix):
    """Returns the flags of sonject-static, with its variable `prefix` set to the present prefix."""
    installed = next(prefix.rglob("sonject-static.pc"))
    return subprocess.run(["pkg-config", f"--define-variable=prefix={prefix}", "--cflags", "--libs",
                           "sonject-static"], capture_output=True, text=True, check=True,
                          env={**os.environ, "PKG_CONFIG_PATH": str(installed.parent)}
                          ).stdout.split()


def library_folder(prefix):
    return next(prefix.rglob("libsonject.so.0.*")).parent


def start(program, prefix):
    """Runs the program and returns its output."""
    answer = subprocess.run([program, "short"], capture_output=True, text=True, check=False,
                            cwd=program.parent,
                            env={**os.environ, "LD_LIBRARY_PATH": str(library_folder(prefix))})
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


def run_program(program, prefix):
    assert "right" in start(program, prefix)


def test_headers_and_library_are_there(root, prefix):
    def headers(folder):
        return {path.relative_to(folder) for path in folder.rglob("*.h*")}

    sources = headers(SOURCE / "include") | headers(SOURCE / "bindings" / "cxx")
    assert headers(prefix / "include") == sources
    assert (library_folder(prefix) / "cmake" / "sonject" / "sonjectConfig.cmake").exists()
    assert str(root) in " ".join(pkg_config_flags(root))
    licence = prefix / "share" / "doc" / "sonject" / "LICENSE"
    assert licence.read_bytes() == (SOURCE / "LICENSE").read_bytes()


# Functions without a wrapper of their own: the C function is enough, or another wrapper covers it.
LEFT_TO_C = {"sonject_absorption"}


def test_cxx_has_every_function():
    headers = "".join(path.read_text(encoding="utf-8")
                      for path in (SOURCE / "bindings" / "cxx").rglob("*.hpp"))
    used = set(re.findall(r"\bsonject_\w+(?=\()", headers))
    functions = set((SOURCE / "tests" / "abi" / "symbols.txt").read_text().split())
    assert functions - used == LEFT_TO_C


# A program around the example at the head of sonject.hpp.
HEAD = """\
#include <cstdio>
#include <sonject.hpp>

int main()
{
    const std::uint32_t rows = 64, columns = 80;
    std::vector<float> pixels(rows * columns, 0.1f);
    const std::vector<float> before = pixels;
%s
    std::puts(pixels != before ? "all right" : "nothing changed");
}
"""


def test_the_example_of_the_header_runs(root, prefix, tmp_path):
    header = (SOURCE / "bindings" / "cxx" / "sonject.hpp").read_text(encoding="utf-8")
    example = re.findall(r"^ \*     (.*)$", header[: header.index("*/")], flags=re.M)
    assert len(example) > 5
    (tmp_path / "example.cpp").write_text(HEAD % "\n".join(example))
    subprocess.run([CXX_COMPILER, "-std=c++11", *WARNINGS, tmp_path / "example.cpp",
                    *pkg_config_flags(root), "-o", tmp_path / "program"], check=True)
    run_program(tmp_path / "program", prefix)


def block(language):
    """Returns the only block of docs/embedding.md in that language."""
    (found,) = re.findall(rf"^```{language}\n(.*?)^```", PAGE, flags=re.S | re.M)
    return found


@pytest.mark.parametrize("language, compiler, standard", [
    ("c", os.environ.get("CC", "cc"), "-std=c99"), ("cpp", CXX_COMPILER, "-std=c++11")])
def test_programs_of_the_page_build_and_run(root, prefix, tmp_path, language, compiler, standard):
    program = tmp_path / f"program.{language}"
    program.write_text(block(language))
    subprocess.run([compiler, standard, *WARNINGS, program, *pkg_config_flags(root), "-o", tmp_path / "program"], check=True)
    start(tmp_path / "program", prefix)


@pytest.fixture
def cmake(prefix, tmp_path):
    """Builds by rules into tmp_path / "build" and returns what CMake told."""
    if not shutil.which("cmake"):
        pytest.skip("cmake is not installed")

    def build(rules):
        (tmp_path / "CMakeLists.txt").write_text(rules)
        told = subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}"],
                              check=True, stdout=subprocess.PIPE, text=True).stdout
        subprocess.run(["cmake", "--build", tmp_path / "build"], check=True, stdout=subprocess.DEVNULL)
        return told

    return build


def test_rules_of_the_page_build_its_program_by_cmake(cmake, prefix, tmp_path):
    (tmp_path / "program.c").write_text(block("c"))
    cmake(block("cmake"))
    start(tmp_path / "build" / "program", prefix)


def test_programs_build_by_pkg_config(root, prefix, tmp_path):
    built = tmp_path / "program"
    program = SOURCE / "tests" / "abi" / "cxx_checks.cpp"
    subprocess.run([CXX_COMPILER, "-std=c++11", *WARNINGS, program, *pkg_config_flags(root), "-o",
                    built], check=True)
    run_program(built, prefix)
    subprocess.run([CXX_COMPILER, "-std=c++20", *WARNINGS, "-fsyntax-only", program,
                    *pkg_config_flags(root)], check=True)


def test_the_example_builds_by_cmake(cmake, prefix, tmp_path):
    cmake(f"""\
cmake_minimum_required(VERSION 3.16)
project(train CXX)
set(CMAKE_CXX_STANDARD 17)
find_package(sonject 0.1 REQUIRED)
add_executable(train {EXAMPLE})
target_link_libraries(train sonject::sonject)
""")
    run_program(tmp_path / "build" / "train", prefix)


def test_cmake_knows_the_version(cmake):
    told = cmake("""\
cmake_minimum_required(VERSION 3.16)
project(t C)
foreach(version 0.1 0.2 1)
  find_package(sonject ${version} QUIET)
  message(STATUS "${version}: ${sonject_FOUND}")
  unset(sonject_DIR CACHE)
endforeach()
""")
    assert re.findall(r"^-- ([\d.]+): (\w+)$", told, re.M) == [("0.1", "1"), ("0.2", "0"), ("1", "0")]


# A program whose variables have the names of internal functions of the library.
STATIC = """\
#include <stdio.h>
#include <string.h>
#include <sonject/sonject.h>

int scene_clear = 1, hash_begin = 2, mesh_load = 3, point_response_init = 4;

int main(int count, char **words)
{
    sonject_context *context = NULL;
    sonject_scene *scene = NULL;
    sonject_convert_params files = {.struct_size = sizeof files};
    files.input = words[1];
    files.output = words[count - 1];
    if (sonject_context_create(NULL, &context) == SONJECT_OK &&
        sonject_scene_create(context, &scene) == SONJECT_OK &&
        sonject_scene_set(scene, "objects[0]", "{shape: sphere, diameter: 1}") == SONJECT_OK &&
        sonject_scene_set(scene, "input.path", "none.png") == SONJECT_OK &&
        sonject_check(context, scene, NULL) != SONJECT_OK &&
        (count < 3 || sonject_convert(context, &files) == SONJECT_OK) &&
        strcmp(sonject_version(), "0.1.0") == 0)
        puts("all right");
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    return scene_clear + hash_begin + mesh_load + point_response_init != 10;
}
"""


def needed_by(file):
    return subprocess.run(["readelf", "-d", file], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def static_library(prefix):
    found = list(prefix.rglob("libsonject-static.a"))
    if not found:
        pytest.skip("built without the static library")
    return found[0]


def assert_stands_alone(program, *files):
    needed = needed_by(program)
    assert "libtiff" in needed and "libsonject" not in needed
    answer = subprocess.run([program, *files], capture_output=True, text=True, check=False)
    assert (answer.returncode, answer.stdout) == (0, "all right\n"), answer.stderr


def test_the_static_library_shows_the_interface_alone(static_library):
    listing = subprocess.run(["nm", "-g", "--defined-only", static_library], capture_output=True,
                             text=True, check=True).stdout
    names = {line.split()[-1] for line in listing.splitlines() if len(line.split()) == 3}
    assert names == set((SOURCE / "tests" / "abi" / "symbols.txt").read_text().split())


def test_programs_link_the_static_library_by_pkg_config(static_library, prefix, tmp_path):
    (tmp_path / "program.c").write_text(STATIC)
    subprocess.run([os.environ.get("CC", "cc"), "-std=c99", *WARNINGS, tmp_path / "program.c",
                    *pkg_config_static(prefix), "-o", tmp_path / "program"], check=True)
    files = [tmp_path / "a.npy", tmp_path / "a.png", tmp_path / "b.npy"]
    numpy.save(files[0], numpy.zeros((2, 3), "u1"))
    assert_stands_alone(tmp_path / "program", *files[:2])
    (decoder,) = prefix.rglob("sonject-decoder")
    shutil.copy(decoder, tmp_path)
    assert_stands_alone(tmp_path / "program", *files[1:])
    assert (numpy.load(files[2]) == numpy.load(files[0])).all()


def test_programs_link_the_static_library_by_cmake(static_library, cmake, tmp_path):
    (tmp_path / "program.c").write_text(STATIC)
    cmake("""\
cmake_minimum_required(VERSION 3.16)
project(program C)
find_package(sonject 0.1 REQUIRED)
add_executable(program program.c)
target_link_libraries(program sonject::static)
""")
    assert_stands_alone(tmp_path / "build" / "program")


@pytest.fixture(scope="module")
def command(prefix):
    """Runs the installed command."""
    program = prefix / "bin" / "sonject"
    variables = {**os.environ, "LD_LIBRARY_PATH": str(library_folder(prefix))}
    return lambda *arguments: subprocess.run([program, *arguments], capture_output=True, text=True,
                                             check=True, env=variables).stdout


@pytest.fixture
def convert(prefix, tmp_path):
    """Converts by the installed command, with a library that has no other file beside it."""
    program = prefix / "bin" / "sonject"
    folder = tmp_path / "library"
    (folder / "sonject").mkdir(parents=True)
    (folder / "libsonject.so.0").symlink_to(library_folder(prefix) / "libsonject.so.0")
    numpy.save(tmp_path / "a.npy", numpy.arange(6, dtype="u1").reshape(2, 3))

    def run(name, result):
        return subprocess.run([program, "convert", tmp_path / name, tmp_path / result],
                              capture_output=True, text=True, check=False,
                              env={**os.environ, "LD_LIBRARY_PATH": str(folder)})

    return run


@pytest.mark.parametrize("program, reason", [
    (None, "No such file"), ("#!/bin/sh\nexit 2\n", "another version of sonject")],
    ids=["missing", "of another version"])
def test_images_need_the_decoder_of_this_library(convert, prefix, tmp_path, program, reason):
    (installed,) = prefix.rglob("sonject-decoder")
    decoder = tmp_path / "library" / "sonject" / "sonject-decoder"
    assert convert("a.npy", "b.npy").returncode == 0
    assert convert("a.npy", "a.png").returncode == 0  # both calls decode no image
    if program:
        decoder.write_text(program)
        decoder.chmod(0o755)
    answer = convert("a.png", "c.npy")
    (line,) = answer.stderr.splitlines()
    assert answer.returncode == 3 and reason in line and "a.png" in line
    assert "sonject-decoder" in line and "install sonject again" in line and not (tmp_path / "c.npy").exists()
    shutil.copy(installed, decoder)
    assert convert("a.png", "c.npy").returncode == 0
    for name in ("b.npy", "c.npy"):
        assert (numpy.load(tmp_path / name) == numpy.load(tmp_path / "a.npy")).all()


def test_the_library_needs_neither_opencl_nor_cxx(prefix):
    needed = needed_by(library_folder(prefix) / "libsonject.so.0")
    assert "libtiff" in needed and not any(each in needed for each in ("OpenCL", "libstdc++"))


def read_page(path):
    """Returns the page as a reader sees it. groff must give no warnings."""
    if not shutil.which("groff"):
        pytest.skip("groff is not installed")
    answer = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-rLL=100n", "-P-c", "-P-b", "-P-u",
                             path], capture_output=True, text=True, check=False)
    assert (answer.returncode, answer.stderr) == (0, "")
    return answer.stdout.translate({0x2212: "-", 0x2010: "-"})  # minus signs and hyphens


def test_every_verb_has_its_manual_page(command, prefix):
    verbs = set(re.findall(r"^  sonject (\w+) ", command("--help"), flags=re.M)) - {"help"}
    folder = next(prefix.rglob("man1"))
    assert {path.name for path in folder.iterdir()} == {
        "sonject.1", *(f"sonject-{verb}.1" for verb in verbs)}
    overview = read_page(folder / "sonject.1")
    for verb in verbs:
        assert f"sonject-{verb}(1)" in overview
        page = " ".join(read_page(folder / f"sonject-{verb}.1").split())
        for line in filter(None, command("help", verb).splitlines()):
            assert " ".join(line.split()) in page, line
