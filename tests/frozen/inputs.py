"""Makes the inputs of the frozen scenes, the same bytes everywhere."""

import array
import math
import random
import struct
import zlib

PLAIN = """\
sonject: 1
input:
  path: swath.tif
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 30 m}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 8 m, resolution: 4 cm}
objects:
  - {name: cigar, class: mine, shape: capsule, length: 1.5 m, diameter: 0.4 m, heading: 30 deg,
     burial: 8 cm}
"""
TEXTS = {
    "plain.yaml": PLAIN,
    "bands.yaml": PLAIN
    + "bands: {low: {}, high: {sonar: {frequency: 200 kHz}, seabed: {lambert: -22 dB}}}\n",
    "sidescan.yaml": """\
sonject: 1
input: {path: line.xtf, channel: port, geometry: from_file}
sonar: {kind: real, frequency: 400 kHz, bandwidth: 5 kHz, altitude: from_file,
        array: {length: 0.6 m}}
objects: [{name: ball, shape: sphere, diameter: 1 m, position: {row: 80, column: 120}}]
""",
    "pulse.csv": "time_s, real, imaginary\n-40e-6, 0, 0\n-20e-6, 0.5, 0.1\n0, 1, 0\n"
    "20e-6, 0.5, -0.1\n40e-6, 0, 0\n",
    "response.csv": "along_track_m real imaginary\n-0.1 0 0\n-0.02 0.7 0.1\n0 1 0\n0.1 0 0\n",
    "sway.csv": "along_track_m sway_m\n-20 0\n0 0.002\n20 0.001\n",
    "cast.csv": "depth_m sound_speed_mps\n0 1520\n8 1518\n10 1500\n12 1490\n",
    "roof.ply": "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "-60 -40 0\n60 -40 0\n60 0 40\n-60 0 40\n60 40 0\n-60 40 0\n4 0 1 2 3\n4 3 2 4 5\n",
}


def seabed(rows, columns, seed):
    """Rayleigh amplitudes on ripples, rms 0.1."""
    draw = random.Random(seed).random
    return [
        0.1 * (1 + 0.4 * math.sin(0.21 * column + 0.05 * row)) * math.sqrt(-math.log(1 - draw()))
        for row in range(rows)
        for column in range(columns)
    ]


def grey(amplitudes, most):
    return [min(most, round(most * amplitude)) for amplitude in amplitudes]


def tiff(samples, columns, channels=1, compress=False):
    """samples: an array of B, H or f."""
    rows = len(samples) // columns // channels
    data = samples.tobytes()
    data = zlib.compress(data) if compress else data
    data += bytes(len(data) % 2)
    shorts = {258: [8 * samples.itemsize] * channels, 338: [0] * (channels - 1)}
    shorts[339] = [3 if samples.typecode == "f" else 1] * channels
    longs = {256: columns, 257: rows, 259: 8 if compress else 1, 262: 1, 273: 8, 277: channels}
    longs |= {278: rows, 279: len(data), 284: 1}
    entries = [struct.pack("<HHII", tag, 4, 1, value) for tag, value in longs.items()]
    for tag, values in shorts.items():
        if values:
            packed = struct.pack(f"<{len(values)}H", *values)
            entries.append(struct.pack("<HHI4s", tag, 3, len(values), packed))
    entries.sort(key=lambda entry: struct.unpack_from("<H", entry))
    directory = struct.pack("<H", len(entries)) + b"".join(entries) + bytes(4)
    return struct.pack("<2sHI", b"II", 42, 8 + len(data)) + data + directory


def png(pixels, columns):
    def chunk(name, content):
        return (
            struct.pack(">I", len(content))
            + name
            + content
            + struct.pack(">I", zlib.crc32(name + content))
        )

    lines = b"".join(
        b"\0" + bytes(pixels[start : start + columns]) for start in range(0, len(pixels), columns)
    )
    head = struct.pack(">IIBBBBB", columns, len(pixels) // columns, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(lines))
        + chunk(b"IEND", b"")
    )


def npy(samples, shape, kind="<f4"):
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head.encode() + samples.tobytes()


def mat(samples, rows):
    """MATLAB's version 5, one single array named swath; samples column by column."""

    def element(kind, content):
        return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)

    body = (
        element(6, struct.pack("<II", 7, 0))
        + element(5, struct.pack("<ii", rows, len(samples) // rows))
        + element(1, b"swath")
        + element(7, samples.tobytes())
    )
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H2s", 0x100, b"IM") + element(14, body)


def xtf(rows, samples, slant_range_m):
    """Both sides in 16 bits with position and altitude, after Triton's description."""
    head = bytearray(1024)
    struct.pack_into("<BB", head, 0, 0x7B, 1)
    struct.pack_into("<HH", head, 164, 0, 2)
    for number in range(2):
        struct.pack_into("<BBHHH", head, 256 + 128 * number, 1 + number, number, 0, 1, 2)
    draw = random.Random(9)
    data = bytes(head)
    for row in range(rows):
        ping = bytearray(256)
        size = 256 + 2 * (64 + 2 * samples)
        padding = -size % 64
        struct.pack_into("<HBBHHHI", ping, 0, 0xFACE, 0, 0, 2, 0, 0, size + padding)
        struct.pack_into("<HBBBBBBHHI", ping, 14, 2024, 5, 2, 12, 0, row % 60, 0, 123, 0, row)
        struct.pack_into("<dd", ping, 160, 2000 + 0.08 * row, 1000 + 0.06 * row)
        struct.pack_into("<f", ping, 196, 6)
        data += bytes(ping)
        for number in range(2):
            channel = bytearray(64)
            struct.pack_into(
                "<HHfffff", channel, 0, number, 2, slant_range_m, 0, 0, slant_range_m / 750, 0.1
            )
            struct.pack_into("<I", channel, 42, samples)
            line = [int(3000 * math.sqrt(-math.log(1 - draw.random()))) for _ in range(samples)]
            data += bytes(channel) + struct.pack(f"<{samples}H", *line)
        data += bytes(padding)
    return data


def write_inputs(folder):
    for name, text in TEXTS.items():
        (folder / name).write_text(text)
    rows, columns = 240, 320
    amplitudes = seabed(rows, columns, 1)
    floats = array.array("f", amplitudes)
    turned = array.array(
        "f", [floats[row * columns + c] for c in range(columns) for row in range(rows)]
    )
    pairs = array.array(
        "f",
        [
            value
            for number, amplitude in enumerate(amplitudes)
            for value in (amplitude * math.cos(2.4 * number), amplitude * math.sin(2.4 * number))
        ],
    )
    heights = [
        0.1 * math.sin(0.2 * row) * math.cos(0.1 * c) for row in range(60) for c in range(80)
    ]
    files = {
        "swath.tif": tiff(floats, columns),
        "swath16.tif": tiff(array.array("H", grey(amplitudes, 65535)), columns, compress=True),
        "complex.tif": tiff(pairs, columns, channels=2),
        "swath.npy": npy(pairs, (rows, columns), "<c8"),
        "swath.mat": mat(turned, rows),
        "figure.png": png(grey(seabed(472, 512, 2), 255), 512),
        "heights.npy": npy(array.array("f", heights), (60, 80)),
        "line.xtf": xtf(160, 200, 30.0),
    }
    for number in (1, 2, 3):
        files[f"seabed_{number}.tif"] = tiff(array.array("f", seabed(300, 340, 2 + number)), 340)
    for name, content in files.items():
        (folder / name).write_bytes(content)
