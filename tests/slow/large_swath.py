"""A target put into a swath of 6 GB, with peak memory below 512 MB; all other pixels stay.

    python3 tests/slow/large_swath.py build/tools/sonject FOLDER [none|deflate] [ROWS]

The swath is a BigTIFF in tiles of 16 bits. FOLDER needs 13 GB, and is left as it was."""

import json
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import time
import zlib

import numpy

COLUMNS, TILE, ENTRIES, LIMIT_MB = 49152, 256, 11, 512
HEAD_BYTES = 16 + 8 + ENTRIES * 20 + 8
PATCH = {"column": 20345, "rows": 512, "columns": 512}
SCENE = """\
sonject: 1
input:
  path: swath.tif
  geometry: {row_spacing: 5 cm, column_spacing: 2.5 cm, first_slant_range: 25 m}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}
patch: %s
objects: [{shape: sphere, diameter: 1 m}]
"""


def tile_at(row, column):
    rows = numpy.arange(row, row + TILE, dtype="<u4")[:, None]
    columns = numpy.arange(column, column + TILE, dtype="<u4")
    return ((rows * 40503 ^ columns * 30011) >> 3 & 0x3FFF | 1).astype("<u2")


def write_swath(path, rows, deflates):
    tiles = [(row, column) for row in range(0, rows, TILE) for column in range(0, COLUMNS, TILE)]
    shorts = [(258, 16), (259, 8 if deflates else 1), (262, 1), (277, 1), (284, 1), (322, TILE),
              (323, TILE)]
    entries = [(256, 4, 1, COLUMNS), (257, 4, 1, rows), *((tag, 3, 1, value) for tag, value in shorts),
               (324, 16, len(tiles), HEAD_BYTES), (325, 16, len(tiles), HEAD_BYTES + 8 * len(tiles))]
    places, sizes = [], []
    with open(path, "wb") as file:
        file.seek(HEAD_BYTES + 16 * len(tiles))
        for place in tiles:
            data = tile_at(*place).tobytes()
            data = zlib.compress(data, 1) if deflates else data
            places.append(file.tell())
            sizes.append(len(data))
            file.write(data)
        file.seek(0)
        file.write(struct.pack("<2s3HQQ", b"II", 43, 8, 0, 16, ENTRIES))
        file.write(b"".join(struct.pack("<HHQQ", *entry) for entry in entries) + bytes(8))
        file.write(numpy.array(places + sizes, "<u8").tobytes())


def check_copy(path, rows):
    """Tiles of the copy, all beside the patch as they were, and the patch changed."""
    with open(path, "rb") as file:
        head = dict((tag, value) for tag, _, _, value in struct.iter_unpack(
            "<HHQQ", file.read(HEAD_BYTES)[24:-8]))
        count = rows // TILE * (COLUMNS // TILE)
        tables = []
        for tag in (324, 325):
            file.seek(head[tag])
            tables.append(numpy.frombuffer(file.read(8 * count), "<u8"))
        changed = 0
        for number in range(count):
            row, column = (TILE * part for part in divmod(number, COLUMNS // TILE))
            file.seek(int(tables[0][number]))
            data = file.read(int(tables[1][number]))
            data = zlib.decompress(data) if head[259] & 0xFFFF == 8 else data
            differs = numpy.frombuffer(data, "<u2").reshape(TILE, TILE) != tile_at(row, column)
            changed += differs.sum()
            inside = numpy.logical_and.outer(
                abs(numpy.arange(row, row + TILE) - PATCH["row"] - 255.5) < 256,
                abs(numpy.arange(column, column + TILE) - PATCH["column"] - 255.5) < 256)
            assert not (differs & ~inside).any(), (row, column)
    assert changed > 100


def main():
    command, place = (pathlib.Path(name).resolve() for name in sys.argv[1:3])
    deflates = sys.argv[3:4] == ["deflate"]
    rows = int(sys.argv[4]) if len(sys.argv) > 4 else 65536
    PATCH["row"] = rows // 2 - 133
    with tempfile.TemporaryDirectory(dir=place) as name:
        folder = pathlib.Path(name)
        write_swath(folder / "swath.tif", rows, deflates)
        (folder / "scene.yaml").write_text(SCENE % json.dumps(PATCH))
        start = time.monotonic()
        subprocess.run([command, "run", "scene.yaml", "-o", "out"], check=True, cwd=folder)
        print(f"put into {(folder / 'swath.tif').stat().st_size / 1e9:.2f} GB in "
              f"{time.monotonic() - start:.1f} s")
        check_copy(folder / "out" / "image.tif", rows)
    peak_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"peak memory {peak_mb:.0f} MB (limit {LIMIT_MB})")
    return 0 if peak_mb < LIMIT_MB else 1


if len(sys.argv) < 3:
    sys.exit(__doc__)
sys.exit(main())
