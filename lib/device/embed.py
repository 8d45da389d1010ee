"""Flattens OpenCL sources: each local include is put in once, with #line marks for build logs.

usage: embed.py OUTPUT.c KERNEL_FOLDER ENTRY.cl...
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
    output, folder, entries = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    parts = ['#include "device/device.h"', ""]
    table = []
    for index, entry in enumerate(entries):
        lines = []
        flatten(folder, entry, set(), lines)
        source = ("\n".join(lines) + "\n").encode("utf-8")
        # C99 promises string literals of 4095 characters only; arrays have no limit
        parts.append(f"static const char source_{index}[] = {{")
        for start in range(0, len(source), 24):
            parts.append("    " + "".join(f"{byte}, " for byte in source[start : start + 24]).rstrip())
        parts += ["    0};", ""]
        table.append(f'    {{"{entry}", source_{index}, sizeof source_{index} - 1}},')
    parts += ["const struct embedded_source embedded_sources[] = {", *table, "};", ""]
    pathlib.Path(output).write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
