"""Writes an HTML page as a string literal in C. usage: embed_page.py PAGE.html OUTPUT.c"""
import pathlib
import sys

page, output = map(pathlib.Path, sys.argv[1:])
# Every compiler takes longer literals than C99 promises.
parts = ['#pragma GCC diagnostic ignored "-Woverlength-strings"', '#include "dataset/run.h"', "", "const char report_page[] ="]
for line in page.read_text(encoding="utf-8").splitlines():
    escaped = line.replace("\\", "\\\\").replace('"', '\\"').replace("?", "\\?")
    parts.append(f'    "{escaped}\\n"')
output.write_text("\n".join([*parts, "    ;", ""]), encoding="utf-8")
