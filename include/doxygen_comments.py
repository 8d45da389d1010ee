"""Shows doxygen the headers' plain comments: doxygen_comments.py HEADER

A comment documents what follows it, or what stands before it on its line. Nothing in one is a
command of doxygen's or of HTML.
"""

import re
import sys

MARKS = {"\\": "\\\\", "@": "\\@", "<": "\\<", ">": "\\>", "&": "\\&", "#": "\\#", "%": "\\%"}


def documenting(found):
    before, comment = found.groups()
    text = re.sub(r"[\\@<>&#%]", lambda mark: MARKS[mark[0]], comment)
    return f"{before}/**{'<' if before.strip() else ''}{text}*/"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.stdout.write(re.sub(r"^([^\n]*?)/\*(.*?)\*/", documenting, file.read(), flags=re.S | re.M))


if __name__ == "__main__":
    main()
