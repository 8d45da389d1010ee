"""Small writers and a reader of image files, so that the tests need no image library."""

import struct
import zlib

import numpy

_FORMATS = {"u": 1, "f": 3}  # TIFF's SampleFormat


def tiff_bytes(pixels, width=None, height=None, deflated=False):
    """Returns a little-endian TIFF of (rows, columns) or (rows, columns, channels).

    width, height: false sizes for the header.
    """
    pixels = numpy.ascontiguousarray(pixels)
    rows, columns = pixels.shape[:2]
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    data = pixels.astype(pixels.dtype.newbyteorder("<")).tobytes()
    data = zlib.compress(data) if deflated else data
    shorts = {
        258: [8 * pixels.dtype.itemsize] * channels,  # BitsPerSample
        339: [_FORMATS[pixels.dtype.kind]] * channels,  # SampleFormat
        338: [0] * (channels - 1),  # ExtraSamples
    }
    single = {
        256: width or columns,
        257: height or rows,
        259: 8 if deflated else 1,  # compression
        262: 1,  # black is zero
        273: 8,  # the only strip's place
        277: channels,
        278: height or rows,
        279: len(data),
        284: 1,  # channels interleaved
    }
    entries = b""
    for tag in sorted([*single, *(tag for tag, values in shorts.items() if values)]):
        if tag in single:
            entries += struct.pack("<HHII", tag, 4, 1, single[tag])
        else:
            values = struct.pack(f"<{channels if tag != 338 else channels - 1}H", *shorts[tag])
            assert len(values) <= 4
            entries += struct.pack("<HHI4s", tag, 3, len(values) // 2, values)
    directory = struct.pack("<H", len(entries) // 12) + entries + struct.pack("<I", 0)
    padding = b"\0" * (len(data) % 2)
    return struct.pack("<2sHI", b"II", 42, 8 + len(data) + len(padding)) + data + padding + directory


def png_bytes(pixels, description=b"", head=b"tEXtDescription\0"):
    """Returns an 8 bit grey PNG of (rows, columns). head: what stands before the description in its chunk."""
    rows, columns = pixels.shape
    lines = b"".join(b"\0" + row.astype(numpy.uint8).tobytes() for row in pixels)

    def chunk(name, content):
        checked = name + content
        return struct.pack(">I", len(content)) + checked + struct.pack(">I", zlib.crc32(checked))

    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(head[:4], head[4:] + description)
        + chunk(b"IDAT", zlib.compress(lines))
        + chunk(b"IEND", b"")
    )


def tiff_parts(content):
    """Returns the byte order, the tags and the strips of a TIFF."""
    order = {b"II": "<", b"MM": ">"}[content[:2]]
    version, start = struct.unpack_from(order + "HI", content, 2)
    if version != 42:
        raise ValueError("no TIFF")
    (count,) = struct.unpack_from(order + "H", content, start)
    tags = {}
    for index in range(count):
        place = start + 2 + 12 * index
        tag, kind, length = struct.unpack_from(order + "HHI", content, place)
        if kind in (3, 4):
            code, size = ("H", 2) if kind == 3 else ("I", 4)
            if length * size > 4:
                (value_place,) = struct.unpack_from(order + "I", content, place + 8)
            else:
                value_place = place + 8
            tags[tag] = struct.unpack_from(f"{order}{length}{code}", content, value_place)
    return order, tags, [content[first : first + size] for first, size in zip(tags[273], tags[279])]


def read_tiff(path):
    """Returns the pixels of an uncompressed TIFF in strips, of either byte order."""
    order, tags, strips = tiff_parts(path.read_bytes())
    assert tags.get(259, (1,)) == (1,), "the TIFF is compressed"
    kind = {1: "u", 3: "f"}[tags.get(339, (1,))[0]] + str(tags[258][0] // 8)
    channels = tags.get(277, (1,))[0]
    assert channels == 1 or tags.get(284, (1,)) == (1,), "the TIFF has a plane for each channel"
    row_bytes = tags[256][0] * channels * tags[258][0] // 8
    rows = [min(tags[278][0], tags[257][0] - first) for first in range(0, tags[257][0], tags[278][0])]
    assert [len(strip) for strip in strips] == [row_bytes * each for each in rows]
    pixels = numpy.frombuffer(b"".join(strips), order + kind).reshape(tags[257][0], tags[256][0], channels)
    return pixels[:, :, 0] if channels == 1 else pixels
