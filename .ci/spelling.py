#!/usr/bin/env python3
"""Finds misspelt words: .ci/spelling.py [FILE ...]

codespell looks for common mistakes in the named files, or in all tracked ones: pages, comments, help
and messages. hunspell also checks Markdown pages against a British dictionary. .ci/words lists words
of the field that the dictionary lacks. Fails if a word is misspelt, or if a listed word is in no page.
"""

import pathlib
import re
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[1]
WORDS = TOP / ".ci" / "words"
RARE = "fro,tread,trough"  # correct words that codespell takes for mistakes
# Deliberate mistakes in tests of messages, and in this file.
ON_PURPOSE = "bandwith,cilinder,compsite,diamter,frequncy,lenght,shpere,unifrom,widht"
BINARY = {".png", ".mat"}
# Text that is not read as words: blocks of code, code, targets of links, comments, addresses.
NOT_TEXT = re.compile(r"^```.*?^```|^    .*?$|`[^`]*`|\]\([^)]*\)|<!--.*?-->|https?://\S+", re.M | re.S)
# A word has at least four letters, or a capital and three. Abbreviations and symbols are left out.
WORD = re.compile(r"(?<![\w.])[A-Z]?[a-z]{3,}(?![\w(])")


def tracked():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=TOP, check=True, capture_output=True, text=True).stdout
    return [name for name in listed.split("\0") if name and pathlib.Path(name).suffix not in BINARY]


def common_mistakes(names, *left_out):
    """Returns codespell's lines, "FILE:LINE: word ==> words"."""
    if not names:
        return []
    answer = subprocess.run(["codespell", "-d", "-L", ",".join(left_out), *names], cwd=TOP, check=False,
                            capture_output=True, text=True)
    if answer.returncode not in (0, 65):
        raise SystemExit(answer.stderr)
    return answer.stdout.splitlines()


def unknown_words(text):
    """Returns the words of a page that the dictionary does not have."""
    words = "\n".join(WORD.findall(NOT_TEXT.sub("\n", text)))
    answer = subprocess.run(["hunspell", "-d", "en_GB", "-i", "utf-8", "-l"], input=words, check=True, capture_output=True,
                            text=True)
    return set(answer.stdout.split())


def main():
    names = sys.argv[1:] or tracked()
    tests = [name for name in names if "tests" in pathlib.Path(name).parts or TOP / name == pathlib.Path(__file__).resolve()]
    found = common_mistakes([name for name in names if name not in tests], RARE)
    found += common_mistakes(tests, RARE, ON_PURPOSE)
    known, met = set(WORDS.read_text(encoding="utf-8").split()), set()
    for name in names:
        if name.endswith(".md"):
            unknown = unknown_words((TOP / name).read_text(encoding="utf-8"))
            met |= unknown
            found += [f"{name}: {word}: not in the dictionary, nor in .ci/words" for word in sorted(unknown - known)]
    if not sys.argv[1:]:
        found += [f".ci/words: {word}: in no page" for word in sorted(known - met)]
    print("\n".join(found) or f"{len(names)} files without misspelt words")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
