"""A small writer of XTF files, after Triton's published description of the format."""

import struct

import numpy

PORT, STARBOARD, SUBBOTTOM = 1, 2, 0


def _put(block, place, layout, *values):
    struct.pack_into("<" + layout, block, place, *values)


def file_header(kinds, sample_bytes=2, unipolar=1, units=0):
    """kinds: of the channels; units: 0 for metres, 3 for degrees."""
    block = bytearray(1024)
    _put(block, 0, "BB", 0x7B, 1)
    _put(block, 164, "HH", units, len(kinds))
    for number, kind in enumerate(kinds):
        start = 256 + 128 * number
        _put(block, start, "BBHHHI", kind, number, 0, unipolar, sample_bytes, 0)
    return bytes(block)


def ping(lines, slant_range=30.0, altitude=6.0, position=(0.0, 0.0), number=0):
    """lines: (channel's number, samples as stored) of one ping."""
    body = b""
    for channel, samples in lines:
        head = bytearray(64)
        _put(head, 0, "HHfffff", channel, 2, slant_range, 0.0, 0.0, slant_range / 750.0, 0.1)
        _put(head, 42, "I", len(samples))
        body += bytes(head) + samples.tobytes()
    body += b"\0" * (-(256 + len(body)) % 64)
    block = bytearray(256)
    _put(block, 0, "HBBHHHI", 0xFACE, 0, 0, len(lines), 0, 0, 256 + len(body))
    _put(block, 14, "HBBBBBBH", 2024, 5, 2, 12, 0, 0, 0, 123)
    _put(block, 28, "I", number)
    _put(block, 160, "dd", position[1], position[0])
    _put(block, 196, "f", altitude)
    return bytes(block) + body


def note(text=b"a note of the operator"):
    """A packet that is no ping."""
    body = text.ljust(256 - 14, b"\0")
    return struct.pack("<HBBHHHI", 0xFACE, 1, 0, 0, 0, 0, 14 + len(body)) + body


def xtf_bytes(port, starboard, row_spacing=0.1, empty=(), altitudes=None, **options):
    """Rows x columns of 16 bit samples a side, column 0 next to the track, and a sub-bottom channel
    and notes between them. Port's samples go into the file from far to near, as recorders do. empty:
    rows whose pings have neither position nor altitude. altitudes: of the rows, where they differ."""
    data = file_header([SUBBOTTOM, PORT, STARBOARD], units=options.pop("units", 0))
    for row, (left, right) in enumerate(zip(port, starboard)):
        lines = [
            (0, numpy.arange(7, dtype="<u2")),
            (1, left[::-1].astype("<u2")),
            (2, right.astype("<u2")),
        ]
        if altitudes is not None:
            options["altitude"] = altitudes[row]
        place = (1000.0 + 0.6 * row_spacing * row, 2000.0 + 0.8 * row_spacing * row)
        if row in empty:
            data += ping(lines, number=row, **{**options, "altitude": 0.0})
        else:
            data += ping(lines, position=place, number=row, **options)
        if row % 5 == 0:
            data += note()
    return data
