#!/usr/bin/env python3
"""Prints checksums of the files that a build's command makes of the frozen scenes. They show whether a change
leaves every file as it was.

    outputs.py SONJECT                    prints a line for each file: checksum, two spaces, name
    outputs.py SONJECT|LIST SONJECT|LIST  compares two builds' commands, or such lists (*.txt)
    --scenes NAME,...                     takes only these scenes of scenes.txt
    --keep DIR                            leaves the files in DIR/1 and DIR/2

Exit status: 0 nothing differs, 1 something does. Images, arrays and JSON have a second line,
NAME:content, with the checksum of their pixels or values. It tells another encoding of the same
content from another content. A build takes 80 seconds of a core if PoCL has compiled the kernels
before.
"""

import argparse
import ast
import concurrent.futures
import hashlib
import io
import json
import pathlib
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

from PIL import Image

from inputs import write_inputs
from images import tiff_parts  # in a folder that inputs adds

# Members of JSON that are not compared, by reason.
LEFT_OUT_FOR = {
    "time": ["times_s", "seconds", "images_per_second", "changed_ns"],
    "the machine": ["peak_memory_bytes", "device"],
    "the version": ["sonject", "sonject's kernels"],
    "hashes of scenes and inputs": ["scene_hash", "campaign_hash", "hash", "inputs"],
    "the file has lines of its own": ["bytes", "xxh3"],
}
LEFT_OUT = {name for names in LEFT_OUT_FOR.values() for name in names}
# Hashes and versions in reports for reading, which are not compared either.
LEFT_OUT_OF_HTML = rb"[0-9a-f]{32}|sonject [0-9.]+"
# Files without a line. Sums name the code that traced them; the output of `form` and `merge` is compared instead.
UNLISTED = ["*.impulses", "*/work/*", "*/times.json"]


def json_forms(text):
    """Returns the document as it is laid out, with numbers as they are written, and its values alone."""

    def without(pairs):
        return {name: value for name, value in pairs if name not in LEFT_OUT}

    written = json.loads(text, object_pairs_hook=without, parse_float="float {}".format)
    values = json.loads(text, object_pairs_hook=without)
    return json.dumps(written).encode(), json.dumps(values, sort_keys=True).encode()


def png_pixels(content):
    image = Image.open(io.BytesIO(content))
    return repr((image.mode, image.size, image.getpalette())).encode() + image.tobytes()


def tiff_pixels(content):
    """Reads a little-endian file of strips, plain or deflated without a predictor."""
    order, tags, strips = tiff_parts(content)
    if order != "<" or tags[259][0] not in (1, 8, 32946) or tags.get(317, (1,)) != (1,):
        raise ValueError
    if tags[259] != (1,):
        strips = [zlib.decompress(strip) for strip in strips]
    return repr([tags.get(tag) for tag in (256, 257, 258, 277, 339)]).encode() + b"".join(strips)


def npy_pixels(content):
    end = content.index(b"\n") + 1
    return repr(sorted(ast.literal_eval(content[10:end].decode()).items())).encode() + content[end:]


def read_scenes():
    """Returns the lines of commands, by scene."""
    scenes = {}
    text = (pathlib.Path(__file__).parent / "scenes.txt").read_text()
    for line in re.sub(r"\n +", " ", text).splitlines():
        if line.startswith("["):
            commands = scenes[line[1:-1]] = []
        elif line and not line.startswith("#"):
            commands.append(line)
    return scenes


SCENES = read_scenes()
CONTENTS = {".png": png_pixels, ".tif": tiff_pixels, ".npy": npy_pixels}


def digest(content):
    return hashlib.sha256(content).hexdigest()[:16]


def checksums(path, name, place):
    """Returns the lines of one file: (name, checksum)."""
    content = path.read_bytes().replace(str(place).encode(), b"PLACE")
    if path.suffix == ".json":
        written, values = json_forms(content)
        return [(name, digest(written)), (name + ":content", digest(values))]
    if b' id="data">' in content:  # report.html, which shows this document
        head, text = content.split(b' id="data">')
        text, rest = text.split(b"</script>", 1)
        written, values = json_forms(text)
        return [(name, digest(head + written + rest)), (name + ":content", digest(values))]
    if path.suffix == ".html":
        content = re.sub(LEFT_OUT_OF_HTML, b"", content)
    lines = [(name, digest(content))]
    if path.suffix in CONTENTS:
        try:
            lines.append((name + ":content", digest(CONTENTS[path.suffix](content))))
        except (ValueError, KeyError, OSError, struct.error, zlib.error):
            lines.append((name + ":content", "unread-" + digest(content)))
    return lines


def scene_lines(command, name, place):
    """Runs the scene's commands and returns the lines of the files that they leave."""
    folder = place / name
    folder.mkdir()
    for number, line in enumerate(SCENES[name], 1):
        verb, *words = shlex.split(line.replace("@", "../inputs/"))
        arguments = [verb]
        for word in words:
            arguments += ["--set", word] if "=" in word and word[0] != "-" else [word]
        if verb in ("run", "form", "elements", "campaign") and "-o" not in words:
            arguments += ["-o", "out"]
        done = subprocess.run([command, *arguments], cwd=folder, capture_output=True)
        (folder / f"{number}.messages").write_bytes(b"exit %d\n" % done.returncode + done.stderr)
        if done.stdout:
            suffix = "json" if verb == "measure" else "stdout"
            (folder / f"{number}.{suffix}").write_bytes(done.stdout)
    return folder_lines(folder, name, place)


def folder_lines(folder, name, place):
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return [
        line
        for path in paths
        if not any(path.match(pattern) for pattern in UNLISTED)
        for line in checksums(path, name + "/" + path.relative_to(folder).as_posix(), place)
    ]


def build_lines(command, names, place):
    """Returns the lines of all files that the build's command makes, {name: checksum}."""
    place.mkdir(parents=True)
    place = place.resolve()
    tools = pathlib.Path(__file__).resolve().parents[2] / "tools"
    for name in ("scenes", "targets", "campaigns"):
        shutil.copytree(tools / name, place / "inputs" / name)
    write_inputs(place / "inputs")
    command = str(pathlib.Path(command).resolve())
    lines = folder_lines(place / "inputs", "inputs", place)
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        for some in pool.map(scene_lines, *zip(*[(command, name, place) for name in names])):
            lines += some
    return dict(lines)


def differences(before, after):
    """Yields one line for each file that differs."""
    for name in sorted(before.keys() | after.keys()):
        content = name + ":content"
        if name.endswith(":content") or all(
            before.get(key) == after.get(key) for key in (name, content)
        ):
            continue
        if name not in before or name not in after:
            yield f"{'new' if name in after else 'gone':8}  {name}"
        elif content in before and before.get(content) == after.get(content):
            yield f"encoding  {name}"
        else:
            yield f"{'content' if content in before else 'bytes':8}  {name}"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("of", nargs="+", metavar="SONJECT|LIST")
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--keep", metavar="DIR")
    options = parser.parse_args()
    names = options.scenes.split(",")
    lists = []
    with tempfile.TemporaryDirectory(prefix="frozen-") as temporary:
        for number, source in enumerate(options.of, 1):
            if source.endswith(".txt"):
                pairs = [line.split("  ", 1) for line in open(source).read().splitlines()]
                asked = [*names, "inputs"]
                lists.append({name: sum_ for sum_, name in pairs if name.split("/")[0] in asked})
            else:
                place = pathlib.Path(options.keep or temporary) / str(number)
                lists.append(build_lines(source, names, place))
    if len(lists) == 1:
        print("\n".join(f"{checksum}  {name}" for name, checksum in lists[0].items()))
        return 0
    lines = list(differences(*lists))
    print("\n".join(lines + [f"{len(lines)} of {len(lists[1])} lines differ"]))
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
