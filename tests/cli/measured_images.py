"""Readers of measured sonar images, which the project does not ship."""

import os
import pathlib
import struct

import numpy
import pytest
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(os.environ.get("SONJECT_MEASURED_IMAGES", ROOT.parent / "shared" / "data"))


def measured(name):
    """Returns the path of a measured image, or skips the test if the image is missing."""
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"{path} is not there: measured images are not shipped; "
                    "SONJECT_MEASURED_IMAGES names the folder that has them")
    return path


def read_png(path):
    """Returns the pixels of an 8 bit PNG: grey levels, palette numbers, or (rows, columns, 3)."""
    image = Image.open(path)
    assert image.mode in ("L", "P", "RGB")
    return numpy.array(image)


def read_xtf(path):
    """Returns the samples of the port channel, a row for each ping, from near to far, and altitudes, m.

    The layout follows Triton Imaging's description of the XTF format. Packets follow a file header of
    1024 bytes. Sonar packets (kind 0) have a header of 256 bytes, and for each channel a header of 64
    bytes and its samples.
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
