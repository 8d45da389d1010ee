"""Just enough writers of image files, so that the tests need no image library."""

import struct
import zlib

import numpy

_FORMATS = {"u": 1, "f": 3}  # TIFF's SampleFormat


def tiff_bytes(pixels, width=None, height=None):
    """An uncompressed little-endian TIFF of (rows, columns) or (rows, columns, channels).

    width, height: what the header says instead of the truth.
    """
    pixels = numpy.ascontiguousarray(pixels)
    rows, columns = pixels.shape[:2]
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    data = pixels.astype(pixels.dtype.newbyteorder("<")).tobytes()
    shorts = {
        258: [8 * pixels.dtype.itemsize] * channels,  # BitsPerSample
        339: [_FORMATS[pixels.dtype.kind]] * channels,  # SampleFormat
        338: [0] * (channels - 1),  # ExtraSamples
    }
    single = {
        256: width or columns,
        257: height or rows,
        259: 1,  # no compression
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


def png_bytes(pixels, description=b""):
    """An 8 bit grey PNG of (rows, columns)."""
    rows, columns = pixels.shape
    lines = b"".join(b"\0" + row.astype(numpy.uint8).tobytes() for row in pixels)

    def chunk(name, content):
        checked = name + content
        return struct.pack(">I", len(content)) + checked + struct.pack(">I", zlib.crc32(checked))

    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"tEXt", b"Description\0" + description)
        + chunk(b"IDAT", zlib.compress(lines))
        + chunk(b"IEND", b"")
    )


def read_tiff(path):
    """Pixels of an uncompressed TIFF in strips, of either byte order."""
    content = path.read_bytes()
    order = {b"II": "<", b"MM": ">"}[content[:2]]
    assert struct.unpack_from(order + "H", content, 2) == (42,)
    (start,) = struct.unpack_from(order + "I", content, 4)
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
    assert tags.get(259, (1,)) == (1,), "the TIFF is compressed"
    data = b"".join(
        content[first : first + length] for first, length in zip(tags[273], tags[279])
    )
    kind = {1: "u", 3: "f"}[tags.get(339, (1,))[0]] + str(tags[258][0] // 8)
    channels = tags.get(277, (1,))[0]
    pixels = numpy.frombuffer(data, order + kind).reshape(tags[257][0], tags[256][0], channels)
    return pixels[:, :, 0] if channels == 1 else pixels


def _zipped(data):
    """As OpenEXR does it: every other byte, differences, deflate; plain where that is no shorter."""
    halves = numpy.frombuffer(data, "u1")
    halves = numpy.concatenate([halves[::2], halves[1::2]])
    halves[1:] = numpy.diff(halves) + numpy.uint8(128)
    packed = zlib.compress(halves.tobytes())
    return packed if len(packed) < len(data) else data


def exr_bytes(channels, compression=0, note=b"", upwards=False):
    """An OpenEXR image of scanlines; channels: arrays by their names, float32 or float16.

    compression: 0, none, or 3, zip; of others there is only the header's word.
    """
    names = sorted(channels)
    pixels = {name: numpy.ascontiguousarray(channels[name]) for name in names}
    rows, columns = pixels[names[0]].shape

    def attribute(name, kind, content):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(content)) + content

    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<I4B2I", 1 if pixels[name].itemsize == 2 else 2, 0, 0,
                                            0, 0, 1, 1) for name in names)
    window = struct.pack("<4i", 0, 0, columns - 1, rows - 1)
    head = struct.pack("<II", 20000630, 2) + b"".join([
        attribute(b"channels", b"chlist", listed + b"\0"),
        attribute(b"compression", b"compression", bytes([compression])),
        attribute(b"dataWindow", b"box2i", window),
        attribute(b"displayWindow", b"box2i", window),
        attribute(b"lineOrder", b"lineOrder", bytes([upwards])),
        attribute(b"note", b"string", note),
        attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        attribute(b"screenWindowCenter", b"v2f", bytes(8)),
        attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))]) + b"\0"
    firsts = range(0, rows, 16 if compression == 3 else 1)
    place = len(head) + 8 * len(firsts)
    chunks, places = b"", {}
    for first in reversed(firsts) if upwards else firsts:
        data = b"".join(pixels[name][row].tobytes()
                        for row in range(rows)[first:first + firsts.step] for name in names)
        data = _zipped(data) if compression == 3 else data
        places[first] = place + len(chunks)
        chunks += struct.pack("<iI", first, len(data)) + data
    return head + struct.pack(f"<{len(firsts)}Q", *(places[first] for first in firsts)) + chunks
