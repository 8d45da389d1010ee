"""Makes the inputs of the frozen scenes, the same bytes everywhere."""

import math
import pathlib
import random
import sys

import numpy

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "cli"), str(TESTS / "fuzz")]
from corpora import MAT_HEAD, mat_array  # noqa: E402
from images import png_bytes, tiff_bytes  # noqa: E402
from recordings import xtf_bytes  # noqa: E402

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
    """Returns Rayleigh amplitudes on ripples, rms 0.1. Python's own functions give the same with every version of NumPy."""
    draw = random.Random(seed).random
    return numpy.array([
        [0.1 * (1 + 0.4 * math.sin(0.21 * column + 0.05 * row)) * math.sqrt(-math.log(1 - draw()))
         for column in range(columns)]
        for row in range(rows)])


def grey(amplitudes, most, kind):
    return numpy.minimum(most, numpy.rint(most * amplitudes)).astype(kind)


def write_inputs(folder):
    for name, text in TEXTS.items():
        (folder / name).write_text(text)
    rows, columns = 240, 320
    amplitudes = seabed(rows, columns, 1)
    floats = amplitudes.astype("<f4")
    phases = [2.4 * number for number in range(rows * columns)]
    turns = [[math.cos(phase), math.sin(phase)] for phase in phases]
    pairs = (amplitudes[..., None] * numpy.reshape(turns, (rows, columns, 2))).astype("<f4")
    heights = [[0.1 * math.sin(0.2 * row) * math.cos(0.1 * c) for c in range(80)] for row in range(60)]
    sides = [3000 * 10 * seabed(160, 200, seed) for seed in (9, 10)]
    files = {
        "swath.tif": tiff_bytes(floats),
        "swath16.tif": tiff_bytes(grey(amplitudes, 65535, "<u2"), deflated=True),
        "complex.tif": tiff_bytes(pairs),
        "swath.mat": MAT_HEAD + mat_array(b"swath", 7, floats),
        "figure.png": png_bytes(grey(seabed(472, 512, 2), 255, "u1")),
        "line.xtf": xtf_bytes(*(side.astype("<u2") for side in sides)),
    }
    for number in (1, 2, 3):
        files[f"seabed_{number}.tif"] = tiff_bytes(seabed(300, 340, 2 + number).astype("<f4"))
    for name, content in files.items():
        (folder / name).write_bytes(content)
    numpy.save(folder / "swath.npy", pairs.view("<c8")[..., 0])
    numpy.save(folder / "heights.npy", numpy.array(heights, "<f4"))
