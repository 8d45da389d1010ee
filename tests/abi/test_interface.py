"""Tests of the library's interface: exported symbols, headers that compile alone, sizes of structures."""
import os
import pathlib
import re
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
LIBRARY = pathlib.Path(os.environ["SONJECT_LIBRARY"])
HEADERS = sorted((SOURCE / "include" / "sonject").glob("*.h"))
CXX_HEADERS = sorted((SOURCE / "bindings" / "cxx" / "sonject").glob("*.hpp"))
COMPILER = os.environ.get("CC", "cc")
CXX_COMPILER = os.environ.get("CXX", "c++")


def exported_symbols(library):
    listing = subprocess.run(["nm", "-D", "--defined-only", library], check=True,
                             capture_output=True, text=True).stdout
    names = {line.split()[-1].split("@")[0] for line in listing.splitlines()}
    return {name for name in names if name != "SONJECT_0"}


def test_exports_are_the_checked_in_list():
    listed = set((SOURCE / "tests" / "abi" / "symbols.txt").read_text().split())
    assert exported_symbols(LIBRARY) == listed


def test_exports_are_the_declared_functions():
    declared = set()
    for header in HEADERS:
        declared |= set(re.findall(r"\b(sonject_\w+)\s*\(", re.sub(
            r"/\*.*?\*/|^\s*#.*?$", "", header.read_text(), flags=re.S | re.M)))
    functions = {name for name in declared if not name.endswith("_function")}
    assert exported_symbols(LIBRARY) == functions


def compile_alone(header, language, source):
    """Compiles a program that includes the header twice, so the header needs an include guard."""
    is_c = language == "c99"
    source.write_text(f"#include <sonject/{header.name}>\n"
                      f"#include <sonject/{header.name}>\nint main(void) {{ return 0; }}\n")
    subprocess.run([COMPILER if is_c else CXX_COMPILER, f"-std={language}", "-Wall", "-Wextra",
                    "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-fsyntax-only", "-I",
                    SOURCE / "include", "-I", SOURCE / "bindings" / "cxx", source], check=True)


@pytest.mark.parametrize("header", HEADERS, ids=lambda header: header.name)
@pytest.mark.parametrize("language", ["c99", "c++11", "c++20"])
def test_headers_compile_alone(header, language, tmp_path):
    compile_alone(header, language, tmp_path / ("alone.c" if language == "c99" else "alone.cpp"))


@pytest.mark.parametrize("header", CXX_HEADERS, ids=lambda header: header.name)
def test_cxx_headers_compile_alone(header, tmp_path):
    compile_alone(header, "c++11", tmp_path / "alone.cpp")


def test_the_whole_cxx_header_includes_each():
    whole = (SOURCE / "bindings" / "cxx" / "sonject.hpp").read_text(encoding="utf-8")
    assert CXX_HEADERS
    assert set(re.findall(r"^#include <sonject/(\w+\.hpp)>$", whole, flags=re.M)) == {
        header.name for header in CXX_HEADERS}


# Sizes on 64-bit machines. A structure may only grow, at its end, in a release that says so.
SIZES = {
    "sonject_box": 32,
    "sonject_calibrate_params": 64,
    "sonject_campaign_image": 192,
    "sonject_campaign_fit_params": 40,
    "sonject_campaign_run_params": 48,
    "sonject_contact_measures": 360,
    "sonject_context_params": 56,
    "sonject_convert_params": 80,
    "sonject_device_info": 400,
    "sonject_element_layout": 176,
    "sonject_elements_params": 128,
    "sonject_form_params": 40,
    "sonject_measure_params": 104,
    "sonject_measurement": 72,
    "sonject_merge_params": 16,
    "sonject_object_truth": 376,
    "sonject_pixels": 48,
    "sonject_quicklook_params": 80,
    "sonject_run_params": 48,
    "sonject_scene_read_params": 24,
    "sonject_statistics": 240,
}


def test_every_structure_has_its_size_above():
    declared = set()
    for header in HEADERS:
        declared |= set(re.findall(r"^typedef struct (\w+) \{", header.read_text(), flags=re.M))
    assert declared == set(SIZES)


def test_structures_keep_their_sizes(tmp_path):
    source = tmp_path / "sizes.c"
    lines = "".join(f'printf("{name} %zu\\n", sizeof({name}));' for name in SIZES)
    source.write_text("#include <stdio.h>\n#include <sonject/sonject.h>\n"
                      f"int main(void) {{ {lines} return 0; }}\n")
    program = tmp_path / "sizes"
    subprocess.run([COMPILER, "-std=c99", "-I", SOURCE / "include", source, "-o", program],
                   check=True)
    output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    assert dict((name, int(size)) for name, size in map(str.split, output.splitlines())) == SIZES
