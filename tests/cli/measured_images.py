"""Measured sonar images that the project does not ship, and what is read out of them."""

import os
import pathlib
import struct
import zlib

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(os.environ.get("SONJECT_MEASURED_IMAGES", ROOT.parent / "shared" / "data"))


def measured(name):
    """The path of a measured image; skips the test where there is none."""
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"{path} is not there: measured images are not shipped; "
                    "SONJECT_MEASURED_IMAGES names the folder that has them")
    return path


def _unfiltered(lines, columns, step):
    """The rows of a PNG, in bytes, step of them a pixel (RFC 2083, filters 0 to 4)."""
    rows = numpy.zeros((len(lines) // (columns + 1), columns), numpy.uint8)
    above = numpy.zeros(columns, numpy.uint8)
    for number, row in enumerate(rows):
        start = number * (columns + 1)
        kind, line = lines[start], lines[start + 1 : start + 1 + columns]
        if kind == 0:
            row[:] = numpy.frombuffer(line, numpy.uint8)
        elif kind == 2:
            row[:] = numpy.frombuffer(line, numpy.uint8) + above
        else:
            for i, value in enumerate(line):
                left, corner = (int(row[i - step]), int(above[i - step])) if i >= step else (0, 0)
                up = int(above[i])
                if kind == 1:
                    guess = left
                elif kind == 3:
                    guess = (left + up) // 2
                else:
                    distances = [abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)]
                    guess = (left, up, corner)[distances.index(min(distances))]
                row[i] = (value + guess) & 255
        above = row
    return rows


def read_png(path):
    """Pixels of an 8 bit PNG: grey, numbers of colours, or (rows, columns, 3)."""
    content = path.read_bytes()
    columns, rows, depth, colour = struct.unpack(">IIBB", content[16:26])
    assert depth == 8 and colour in (0, 2, 3)
    step = 3 if colour == 2 else 1
    position, data = 8, b""
    while position < len(content):
        size, name = struct.unpack(">I4s", content[position : position + 8])
        if name == b"IDAT":
            data += content[position + 8 : position + 8 + size]
        position += 12 + size
    pixels = _unfiltered(zlib.decompress(data), step * columns, step)[:rows]
    return pixels.reshape(rows, columns, 3) if step == 3 else pixels


def read_xtf(path):
    """Samples of the port channel, rows of pings, columns from near to far, and their altitudes.

    After Triton Imaging's description of the XTF format: a file header of 1024 bytes, then packets;
    sonar packets (kind 0) have a header of 256 bytes and for each channel one of 64 and its
    samples.
    """
    content = path.read_bytes()
    position, pings, altitudes = 1024, [], []
    while position + 256 <= len(content):
        magic, kind, _, channels = struct.unpack_from("<HBBH", content, position)
        assert magic == 0xFACE
        size = struct.unpack_from("<I", content, position + 10)[0]
        if kind == 0 and channels > 0:
            samples = struct.unpack_from("<I", content, position + 256 + 42)[0]
            pings.append(numpy.frombuffer(content, "<u2", samples, position + 256 + 64)[::-1])
            altitudes.append(struct.unpack_from("<f", content, position + 196)[0])
        position += size
    return numpy.array(pings), numpy.array(altitudes)
