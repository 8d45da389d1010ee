#!/usr/bin/env python3
"""Counts the words per sentence in Markdown pages: .ci/readability.py [PAGE ...]

Prints median and 90th percentile of each page. The default pages are README.md, docs and the pages
that lie beside the code they explain. Fails above the limits, or if README.md is too long for readers.
"""

import math
import pathlib
import re
import sys

TOP = pathlib.Path(__file__).resolve().parents[1]
PAGES = ["README.md", "docs/*.md", "bindings/python/README.md", "tools/slurm/README.md"]
MEDIAN, NINETIETH = 15, 28
README_LINES, README_WORDS = 100, 900

# Text that is not read as sentences: blocks of code, comments, tables, headings, pictures.
NOT_TEXT = re.compile(r"^```.*?^```|<!--.*?-->|^    .*?$|^\|.*?$|^#.*?$|!\[[^]]*\]\([^)]*\)", re.M | re.S)
LIST_ITEM = re.compile(r"^ *(?:[-*]|\d+\.) ", re.M)
SENTENCE_END = re.compile(r"(?<=[.!?])[)*\"]*\s+(?=[\"(*`]*[A-Z0-9`])")


def sentences(text):
    """Returns all sentences as lists of words. A list item begins a sentence. A link counts as its text."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", NOT_TEXT.sub("\n\n", text))
    paragraphs = re.split(r"\n\s*\n", LIST_ITEM.sub("\n\n", text))
    found = [part.split() for each in paragraphs for part in SENTENCE_END.split(each)]
    return [words for words in found if words]


def percentile(lengths, share):
    """Returns the smallest length that at least this share of the lengths does not exceed."""
    return sorted(lengths)[max(0, math.ceil(share * len(lengths)) - 1)]


def complaints(name, text):
    lengths = [len(words) for words in sentences(text)]
    median, ninetieth = percentile(lengths, 0.5), percentile(lengths, 0.9)
    print(f"{name}: {len(text.splitlines())} lines, {len(text.split())} words, {len(lengths)} sentences: "
          f"median {median}, 90th percentile {ninetieth} words")
    limits = [("median", median, MEDIAN), ("90th percentile", ninetieth, NINETIETH)]
    if name == "README.md":
        limits += [("lines", len(text.splitlines()), README_LINES), ("words", len(text.split()), README_WORDS)]
    return [f"{name}: {what}: {value}, at most {limit}" for what, value, limit in limits if value > limit]


def main():
    pages = sys.argv[1:] or [str(path.relative_to(TOP)) for each in PAGES for path in sorted(TOP.glob(each))]
    found = [line for name in pages for line in complaints(name, (TOP / name).read_text(encoding="utf-8"))]
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
