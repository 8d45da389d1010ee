"""Measured sonar images that the project does not ship, and what is read out of them."""

import os
import pathlib
import struct

import numpy
import pytest
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(os.environ.get("SONJECT_MEASURED_IMAGES", ROOT.parent / "shared" / "data"))


def measured(name):
    """The path of a measured image; skips the test where there is none."""
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"{path} is not there: measured images are not shipped; "
                    "SONJECT_MEASURED_IMAGES names the folder that has them")
    return path


def read_png(path):
    """Pixels of an 8 bit PNG: grey, numbers of colours, or (rows, columns, 3)."""
    image = Image.open(path)
    assert image.mode in ("L", "P", "RGB")
    return numpy.array(image)


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
