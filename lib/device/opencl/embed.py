"""Flattens OpenCL sources: replaces each local include by its file once, with #line marks for build logs.

usage: embed.py OUTPUT.c OUTPUT.d KERNEL_FOLDER ENTRY.cl...

OUTPUT.d lists all files that were read, as a rule of make.
"""
import pathlib
import re
import sys


def flatten(folder, name, seen, lines):
    seen.add(name)
    text = (folder / name).read_text(encoding="utf-8").splitlines()
    lines.append(f'#line 1 "{name}"')
    for number, line in enumerate(text, 1):
        include = re.match(r'\s*#include "([^"]+)"', line)
        if not include:
            lines.append(line)
            continue
        if include.group(1) not in seen:
            flatten(folder, include.group(1), seen, lines)
        lines.append(f'#line {number + 1} "{name}"')


def main():
    output, rule, folder, entries = *sys.argv[1:3], pathlib.Path(sys.argv[3]), sys.argv[4:]
    used = set()
    # C99 promises literals of 4095 characters, but every compiler takes longer ones. An array of numbers
    # would take as long to compile as a kernel.
    parts = ['#pragma GCC diagnostic ignored "-Woverlength-strings"', '#include "device/device.h"', ""]
    table = []
    for index, entry in enumerate(entries):
        lines = []
        seen = set()
        flatten(folder, entry, seen, lines)
        used |= seen
        parts.append(f"static const char source_{index}[] =")
        parts += ['    "' + line.replace("\\", "\\\\").replace('"', '\\"').replace("?", "\\?") + '\\n"' for line in lines]
        parts += ["    ;", ""]
        table.append(f'    {{"{entry}", source_{index}, sizeof source_{index} - 1}},')
    parts += ["const struct embedded_source embedded_sources[] = {", *table, "};", ""]
    pathlib.Path(output).write_text("\n".join(parts), encoding="utf-8")
    names = " ".join(str(folder / name).replace(" ", "\\ ") for name in sorted(used))
    pathlib.Path(rule).write_text(f"{output}: {names}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
