"""Tags that sonject does not know, such as those of GeoTIFF, stay as they are."""

import struct
import zlib

import numpy
import pytest

from conftest import COLUMNS, ROWS

SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 7: 1, 12: 8}
GEO = {
    33550: (12, struct.pack("<3d", 0.1, 0.1, 0.0)),  # ModelPixelScale
    33922: (12, struct.pack("<6d", 0, 0, 0, 500000.25, 6500000.75, 0)),  # ModelTiepoint
    34735: (3, struct.pack("<12H", 1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32632)),  # GeoKeys
    34736: (12, struct.pack("<2d", 6378137.0, 298.257223563)),
    34737: (2, b"WGS 84 / UTM zone 32N|\0"),
    42113: (2, b"-9999\0"),  # GDAL_NODATA
    65000: (7, b"a private one"),
}


def geotiff_bytes(pixels, compressed):
    strip = pixels.astype("<f4").tobytes()
    strip = zlib.compress(strip) if compressed else strip
    plain = {256: COLUMNS, 257: ROWS, 258: 32, 259: 8 if compressed else 1, 262: 1, 273: 8, 277: 1,
             278: ROWS, 279: len(strip), 339: 3}
    tags = {**{tag: (4, struct.pack("<I", value)) for tag, value in plain.items()}, **GEO}
    start = 8 + len(strip) + len(strip) % 2
    place = start + 2 + 12 * len(tags) + 4
    entries, values = b"", b""
    for tag in sorted(tags):
        kind, value = tags[tag]
        entries += struct.pack("<HHI", tag, kind, len(value) // SIZES[kind])
        entries += value.ljust(4, b"\0") if len(value) <= 4 else struct.pack("<I", place + len(values))
        values += value + b"\0" * (len(value) % 2) if len(value) > 4 else b""
    directory = struct.pack("<H", len(tags)) + entries + struct.pack("<I", 0)
    return struct.pack("<2sHI", b"II", 42, start) + strip.ljust(start - 8, b"\0") + directory + values


def tags_of(data):
    """Each tag's type and bytes."""
    (start,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, start)
    found = {}
    for entry in range(start + 2, start + 2 + 12 * count, 12):
        tag, kind, number = struct.unpack_from("<HHI", data, entry)
        size = number * SIZES[kind]
        place = entry + 8 if size <= 4 else struct.unpack_from("<I", data, entry + 8)[0]
        found[tag] = (kind, data[place:place + size])
    return found


@pytest.mark.parametrize("compressed", [False, True])
def test_all_tags_stay(sonject, tmp_path, scene, swath, compressed):
    before = geotiff_bytes(swath, compressed)
    (tmp_path / "swath.tif").write_bytes(before)
    sonject.done("run", scene, "-o", "out")
    after = (tmp_path / "out/image.tif").read_bytes()
    old, new = tags_of(before), tags_of(after)
    assert GEO.items() <= new.items()
    places = {273, 279} if compressed else set()  # a strip that is coded anew lies elsewhere
    assert old.keys() == new.keys()
    assert {tag for tag in old if old[tag] != new[tag]} <= places
    strip = 4 * ROWS * COLUMNS
    if compressed:
        start, count = (struct.unpack("<I", new[tag][1])[0] for tag in (273, 279))
        samples = zlib.decompress(after[start:start + count])
    else:
        assert len(after) == len(before) and after[:8] == before[:8]
        assert after[8 + strip:] == before[8 + strip:]
        samples = after[8:8 + strip]
    changed = numpy.frombuffer(samples, "<f4").reshape(ROWS, COLUMNS) != swath
    assert 50 < changed.sum() < changed.size
