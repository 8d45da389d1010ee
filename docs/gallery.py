"""Makes the pictures of docs/gallery.md by following that page.

    python3 docs/gallery.py FOLDER

The first line of each scene of the page names the scene's file. The page's Python runs in one
namespace, as a reader would type it. The current folder then has the project's tools and bindings.
SONJECT_LIBRARY and PYTHONPATH choose the build.
"""

import os
import pathlib
import re
import shutil
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[1]
BLOCK = re.compile(r"^```(yaml|python)\n(.*?)^```", re.S | re.M)


def main():
    pictures = pathlib.Path(sys.argv[1]).resolve()
    page = SOURCE / "docs" / "gallery.md"
    names = {}
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        for name in ("tools", "bindings"):
            os.symlink(SOURCE / name, name)
        for language, block in BLOCK.findall(page.read_text(encoding="utf-8")):
            if language == "yaml":
                pathlib.Path(block.split()[1]).write_text(block, encoding="utf-8")
            else:
                exec(compile(block, page, "exec"), names)
        for made in pathlib.Path().glob("*.png"):
            shutil.copy(made, pictures)
        os.chdir(SOURCE)


if __name__ == "__main__":
    main()
