"""Small writers and a reader of XTF and JSF files, after the published descriptions of the formats, and writers of
scenes of such files."""

import struct

import numpy

PORT, STARBOARD, SUBBOTTOM = 1, 2, 0
SCENE = """\
sonject: 1
input: {{path: {name}, {more} geometry: {geometry}}}
patch: {{row: 10, column: 60, rows: 40, columns: 120}}
sonar: {{frequency: 600 kHz, bandwidth: 10 kHz, altitude: {altitude}, resolution: 0.1 m}}
objects: [{{name: can, shape: cylinder, length: 1 m, diameter: 0.4 m, heading: 30 deg}}]
"""
EXPLICIT = "{row_spacing: 0.1 m, column_spacing: 0.15 m, first_slant_range: 0.075 m}"


def write_scene(folder, name, channel="", more="", geometry="from_file", altitude="from_file"):
    """Writes a scene of the recording of that name and returns its path."""
    path = folder / f"{name}.yaml"
    more += f"channel: {channel}," if channel != "" else ""
    path.write_text(SCENE.format(name=name, more=more, geometry=geometry, altitude=altitude))
    return path


def _put(block, place, layout, *values):
    struct.pack_into("<" + layout, block, place, *values)


def file_header(kinds, sample_bytes=2, unipolar=1, units=0):
    """Returns an XTF file header. kinds: one for each channel. units: 0 for metres, 3 for degrees."""
    block = bytearray(1024)
    _put(block, 0, "BB", 0x7B, 1)
    _put(block, 164, "HH", units, len(kinds))
    for number, kind in enumerate(kinds):
        start = 256 + 128 * number
        _put(block, start, "BBHHHI", kind, number, 0, unipolar, sample_bytes, 0)
    return bytes(block)


def ping(lines, slant_range=30.0, altitude=6.0, position=(0.0, 0.0), number=0, weight=0, delay=0.0):
    """Returns one ping of an XTF file. lines: (number of the channel, samples as stored)."""
    body = b""
    for channel, samples in lines:
        head = bytearray(64)
        _put(head, 0, "HHfffff", channel, 2, slant_range, 0.0, delay, slant_range / 750.0 - delay, 0.1)
        _put(head, 42, "I", len(samples))
        _put(head, 58, "h", weight)
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
    """Returns a packet that is no ping."""
    body = text.ljust(256 - 14, b"\0")
    return struct.pack("<HBBHHHI", 0xFACE, 1, 0, 0, 0, 0, 14 + len(body)) + body


def xtf_bytes(port, starboard, row_spacing=0.1, empty=(), altitudes=None, silent=(), weights=None, **options):
    """Returns an XTF file with a sub-bottom channel and notes between the pings. port, starboard: rows x
    columns of 16 bit samples, column 0 next to the track. Port is stored from far to near, as recorders
    do. row_spacing: a number, or each row's place along the track, m. empty: rows whose pings have neither
    position nor altitude. altitudes: one for each row, m. silent: rows whose pings have no samples. weights: one
    for each row."""
    data = file_header([SUBBOTTOM, PORT, STARBOARD], units=options.pop("units", 0))
    for row, (left, right) in enumerate(zip(port, starboard)):
        lines = [
            (0, numpy.arange(7, dtype="<u2")),
            (1, left[::-1].astype("<u2")),
            (2, right.astype("<u2")),
        ]
        if row in silent:
            lines = [(channel, samples[:0]) for channel, samples in lines]
        if altitudes is not None:
            options["altitude"] = altitudes[row]
        if weights is not None:
            options["weight"] = int(weights[row])
        along = row_spacing[row] if numpy.ndim(row_spacing) else row_spacing * row
        place = (1000.0 + 0.6 * along, 2000.0 + 0.8 * along)
        if row in empty:
            data += ping(lines, number=row, **{**options, "altitude": 0.0})
        else:
            data += ping(lines, position=place, number=row, **options)
        if row % 5 == 0:
            data += note()
    return data


def jsf_message(kind, body, subsystem=0, channel=0):
    """Returns a message of a JSF file, after EdgeTech's published description of the format."""
    head = bytearray(16)
    _put(head, 0, "HBBHBBBB", 0x1601, 11, 0, kind, 0, subsystem, channel, 0)
    _put(head, 12, "I", len(body))
    return bytes(head) + body


def jsf_ping(samples, channel, subsystem=20, number=0, spacing=0.15, speed=1500.0, delay=0, altitude=6.0,
             position=(0.0, 0.0), units=1, heading=None, weight=3, kind=None, packet=1, valid=0x49):
    """Returns one side's ping. samples: unsigned 16 bit envelopes or pairs of signed 16 bits, from near to
    far on both sides. delay: samples before the first one. position: in the numbers of `units`. valid:
    the flags of position, heading and altitude."""
    block = bytearray(240)
    count = len(samples)
    if kind is None:
        kind = samples.ndim - 1
    _put(block, 0, "iII", 1714651200 + number // 10, delay, number)
    _put(block, 16, "H", (count >> 16) << 8)
    _put(block, 28, "hH", 1, valid if heading is not None else valid & ~8)
    _put(block, 34, "h", kind)
    _put(block, 80, "iih", round(position[0]), round(position[1]), units)
    _put(block, 114, "HI", count & 0xFFFF, round(2e9 * spacing / speed))
    _put(block, 126, "HH", 59500, 60500)
    _put(block, 144, "if", round(1000 * altitude), speed)
    _put(block, 168, "hh", weight, 1)
    _put(block, 172, "H", round(100 * (heading or 0.0)))
    _put(block, 200, "I", 43200000 + 100 * number)
    _put(block, 220, "H", packet)
    return jsf_message(80, bytes(block) + samples.tobytes(), subsystem, channel)


def jsf_bytes(port, starboard, row_spacing=0.1, subsystems=(20,), empty=(), weights=None, **options):
    """Returns a JSF file of both sides, whose rows are (columns) or (columns, 2). Pings of a sub-bottom
    profiler and other messages lie between. empty: rows without samples. weights: one for each row."""
    kind = "<u2" if port.ndim == 2 else "<i2"
    data = jsf_message(182, bytes(40))
    for row in range(len(port)):
        place = (1e6 + 600 * row_spacing * row, 2e6 + 800 * row_spacing * row)
        told = {"position": place, "number": row, **options}
        if weights is not None:
            told["weight"] = int(weights[row])
        data += jsf_ping(numpy.arange(7, dtype="<u2"), 0, 0, number=row)
        for subsystem in subsystems:
            for channel, side in enumerate((port, starboard)):
                samples = side[row] + (subsystem - subsystems[0])
                data += jsf_ping(samples[:0 if row in empty else None].astype(kind), channel, subsystem, **told)
        if row % 5 == 0:
            data += jsf_message(2020, bytes(44))
    return data


def samples_of(data, side, subsystem=20):
    """Returns the samples of a side of a file as above, 0 for port, and the places of their bytes in the file. Both have
    rows x columns, from near to far, and x 2 if the samples are pairs."""
    place, places = (1024 if data[0] == 0x7B else 0), []
    while place < len(data):
        if data[0] == 0x7B:
            kind, _, channels, size = struct.unpack_from("<2xBBH4xI", data, place)
            start = place + 256
            for _ in range(channels if kind == 0 else 0):
                channel, count = struct.unpack_from("<H40xI", data, start)
                if channel == 1 + side:
                    places.append(start + 64 + 2 * numpy.arange(count)[::1 if side else -1])
                start += 64 + 2 * count
        else:
            mark, kind, found, channel, size = struct.unpack_from("<H2xHxBB3xI", data, place)
            assert mark == 0x1601
            size += 16
            if (kind, found, channel) == (80, subsystem, side):
                form, count = struct.unpack_from("<34xh78xH", data, place + 16)
                places.append(place + 256 + 2 * numpy.arange(count * (1 + form)).reshape(count, 1 + form).squeeze())
        place += size
    places, content = numpy.array(places), numpy.frombuffer(data, "u1").astype("<u2")
    samples = content[places] + 256 * content[places + 1]
    return (samples.view("<i2") if places.ndim == 3 else samples), places


def assert_patch_alone_changed(before, after, side):
    """Asserts that of two files' bytes only samples of that side in the scene's patch differ, and many of these."""
    inside = samples_of(before, side)[1][10:50, 60:180].ravel()
    changed = numpy.frombuffer(before, "u1") != numpy.frombuffer(after, "u1")
    assert (changed[inside] | changed[inside + 1]).sum() > 50
    changed[inside] = changed[inside + 1] = False
    assert not changed.any()
