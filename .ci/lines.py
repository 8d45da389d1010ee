#!/usr/bin/env python3
"""Counts the lines of tracked files by room: .ci/lines.py

A room is a folder of lib or another top folder. Markdown, notebooks and pictures are left out.
"""

import collections
import pathlib
import subprocess
import sys

LEFT_OUT = {".md", ".ipynb", ".png", ".jpg", ".jpeg", ".svg"}
OUTER = ("kernels", "include", "tools", "bindings", "tests")


def room_of(path):
    parts = path.parts
    if "tests" in parts[:-1]:
        return "tests"
    if parts[0] == "lib" and len(parts) > 2:
        return "lib/" + parts[1]
    return parts[0] if parts[0] in OUTER else "other"


def main():
    listed = subprocess.run(["git", "ls-files", "-z"], check=True, stdout=subprocess.PIPE).stdout
    files, lines = collections.Counter(), collections.Counter()
    for name in filter(None, listed.decode().split("\0")):
        path = pathlib.Path(name)
        if path.suffix not in LEFT_OUT and path.is_file():
            files[room_of(path)] += 1
            lines[room_of(path)] += path.read_bytes().count(b"\n")
    last = ["lib", *OUTER, "other"]
    rooms = sorted(lines, key=lambda room: (last.index(room.split("/")[0]), room))
    rows = [(room, files[room], lines[room]) for room in rooms]
    inside = [row for row in rows if row[0].startswith("lib/")]
    rows.insert(len(inside), ("lib", sum(row[1] for row in inside), sum(row[2] for row in inside)))
    rows.append(("without tests", *(sum(count.values()) - count["tests"] for count in (files, lines))))
    rows.append(("total", sum(files.values()), sum(lines.values())))
    print(f"{'room':16}{'files':>7}{'lines':>9}")
    for room, file_count, line_count in rows:
        print(f"{room:16}{file_count:7}{line_count:9,}")


if __name__ == "__main__":
    sys.exit(main())
