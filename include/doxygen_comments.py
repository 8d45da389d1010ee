"""Turns the headers' plain comments into doxygen's: doxygen_comments.py HEADER

A comment documents the declaration after it, or the one before it on its line; at the head of a file, the
file. Commands of doxygen and HTML are escaped. Indented lines stay as they are.
"""

import re
import sys

MARKS = {"\\": "\\\\", "@": "\\@", "<": "\\<", ">": "\\>", "&": "\\&", "#": "\\#", "%": "\\%"}
INDENTED = r"((?:^ \*     .*\n)+)"


def escaped(comment):
    lines = re.split(INDENTED, comment, flags=re.M)
    for i in range(0, len(lines), 2):
        lines[i] = re.sub(r"[\\@<>&#%]", lambda mark: MARKS[mark[0]], lines[i])
    for i in range(1, len(lines), 2):
        indented = re.sub(r"^ \*", "", lines[i], flags=re.M)
        lines[i] = f" * \\verbatim\n{indented}\\endverbatim\n"
    return "".join(lines)


def documenting(found):
    before, comment = found.groups()
    kind = "\\file\n" if found.start() == 0 else "<" if before.strip() else ""
    return f"{before}/**{kind}{escaped(comment)}*/"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.stdout.write(re.sub(r"^([^\n]*?)/\*(.*?)\*/", documenting, file.read(), flags=re.S | re.M))


if __name__ == "__main__":
    main()
