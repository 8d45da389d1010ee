"""Tests of pictures, drawn by the Python that has matplotlib."""

import os
import subprocess

import pytest

from conftest import KEYS, PACKAGE

PROGRAM = f"KEYS = {KEYS}" + """
import matplotlib
matplotlib.use("Agg")
import numpy, sonject
from sonject import plotting

geometry = {"row_spacing": "2.5 cm", "column_spacing": 0.025, "first_slant_range": "25 m"}
scene = sonject.Scene(**KEYS)
patch = numpy.random.default_rng(1).rayleigh(size=(96, 128)).astype(numpy.float32)
patch[0, 0] = 0.0
result = sonject.inject(patch, scene)
figure = plotting.draw_result(patch, result, geometry=geometry)
figure.savefig("picture.png")
before, after, labels = figure.axes
shown = [numpy.asarray(panel.images[0].get_array()) for panel in figure.axes]
changed = numpy.asarray(result.influence) > 0
assert numpy.array_equal(shown[0][~changed], shown[1][~changed])
assert not numpy.array_equal(shown[0], shown[1])
assert (~labels.images[1].get_array().mask == (result.labels > 0)).all()
assert numpy.allclose(after.images[0].get_extent(), [24.9875, 28.1875, 2.3875, -0.0125])
assert after.get_xlabel() == "slant range in m" and after.images[0].get_clim() == before.images[0].get_clim()
ends = 20 * numpy.log10(numpy.quantile(patch[patch > 0], [0.03, 0.998]))
assert numpy.allclose(before.images[0].get_clim(), ends, atol=0.02)
assert plotting.draw(numpy.zeros((2, 3))).get_clim() == (-10.0, 10.0)
assert matplotlib.pyplot.gca().get_ylabel() == "track in rows"
try:
    plotting.draw(numpy.zeros(3))
    raise SystemExit("rows alone were drawn")
except ValueError:
    pass
"""


def test_results_are_drawn(tmp_path):
    reader = os.environ.get("SONJECT_READERS")
    if not reader:
        pytest.skip("SONJECT_READERS does not name a Python that has matplotlib")
    variables = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "MPLCONFIGDIR": str(tmp_path)}
    answer = subprocess.run([reader, "-c", PROGRAM], cwd=tmp_path, env=variables,
                            capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert (tmp_path / "picture.png").stat().st_size > 10000
