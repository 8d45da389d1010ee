"""Tests of generate.py: its structures against the C compiler, and headers that it does not understand."""

import ctypes
import os
import shlex
import subprocess
import sys

import pytest

from conftest import DOCUMENTS
from sonject import _interface

HEADERS = DOCUMENTS.parents[1] / "include" / "sonject"
KEYS_PAGE = DOCUMENTS.parents[1] / "tools" / "scenes" / "KEYS.md"
STRUCTURES = {
    name: kind
    for name, kind in vars(_interface).items()
    if isinstance(kind, type) and issubclass(kind, ctypes.Structure) and hasattr(kind, "_fields_")
}


def layout_program():
    """Returns a C program that prints the size of each structure and the place of each field."""
    lines = ["#include <stddef.h>", "#include <stdio.h>", "#include <sonject/sonject.h>"]
    lines.append("int main(void) {")
    for name, kind in STRUCTURES.items():
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        for field, _ in kind._fields_:
            lines.append(
                f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), '
                f"sizeof((({name} *)0)->{field}));"
            )
    lines.append("return 0; }")
    return "\n".join(lines)


def test_layout_is_the_compilers(tmp_path):
    (tmp_path / "layout.c").write_text(layout_program())
    compiler = shlex.split(os.environ.get("CC", "cc"))
    subprocess.run([*compiler, "-std=c99", f"-I{HEADERS.parent}", "-o", tmp_path / "layout",
                    tmp_path / "layout.c"], check=True)
    printed = subprocess.run([tmp_path / "layout"], check=True, capture_output=True, text=True).stdout
    ours = {}
    for name, kind in STRUCTURES.items():
        ours[name] = [ctypes.sizeof(kind)]
        for field, _ in kind._fields_:
            place = getattr(kind, field)
            ours[f"{name}.{field}"] = [place.offset, place.size]
    rows = (line.split() for line in printed.splitlines())
    assert ours == {row[0]: [int(number) for number in row[1:]] for row in rows}


@pytest.mark.parametrize("found, put, reason", [
    ("    double burial_m;", "    double burial_m, other;", "not understood: double burial_m,"),
    ("} sonject_level_kind;", "} other;", "a typedef is not understood"),
    ("    double grazing_rad;", "    double grazing_rad[3];", "no field for"),
    ("SONJECT_END_DECLARATIONS", "SONJECT_API void *(*sonject_odd(void))(void);", "a function is not understood"),
])
def test_what_is_not_understood_is_refused(tmp_path, found, put, reason):
    for header in HEADERS.glob("*.h"):
        (tmp_path / header.name).write_text(header.read_text())
    changed = tmp_path / "result.h"
    assert found in changed.read_text()
    changed.write_text(changed.read_text().replace(found, put))
    answer = subprocess.run([sys.executable, DOCUMENTS / "generate.py", tmp_path, KEYS_PAGE,
                             *sorted(tmp_path.glob("*.h"))], capture_output=True, text=True, check=False)
    assert answer.returncode != 0 and reason in answer.stderr
