"""Fixtures of the bindings' tests. SONJECT_LIBRARY names the library. The package is the build's:
PYTHONPATH=build/bindings/python."""

import os
import pathlib

import numpy
import pytest

import sonject

DOCUMENTS = pathlib.Path(__file__).resolve().parents[1]
PACKAGE = pathlib.Path(sonject.__file__).resolve().parent  # in the folder of the build

ROWS, COLUMNS = 96, 128
# A proud sphere in the middle of a patch, which is 2.4 m x 3.2 m at about 26 m.
GEOMETRY = {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 25}
KEYS = {
    "sonar": {"frequency": 100e3, "bandwidth": 30e3, "altitude": 10},
    "input": {"geometry": GEOMETRY},
    "objects": [{"shape": "sphere", "diameter": 0.5, "name": "ball"}],
}

CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: 6
chip: {rows: 64, columns: 64, spread: 0.3}
empty: 0.34
swaths: [{path: swath.npy}]
draw:
  objects[].diameter: {uniform: [20 cm, 30 cm]}
targets:
  - {class: ball, object: {shape: sphere}}
"""
CAMPAIGN_SCENE = """\
sonject: 1
input:
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 25 m}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}
"""


def pytest_sessionstart(session):
    if not os.environ.get("SONJECT_LIBRARY"):
        raise pytest.UsageError("set SONJECT_LIBRARY to the path of libsonject")


@pytest.fixture(scope="session")
def context():
    with sonject.Context() as context:
        yield context


@pytest.fixture
def complex_patch():
    """Returns speckle of unit mean intensity."""
    random = numpy.random.default_rng(20240501)
    parts = random.standard_normal((2, ROWS, COLUMNS)) * numpy.sqrt(0.5)
    return (parts[0] + 1j * parts[1]).astype(numpy.complex64)


@pytest.fixture
def amplitude_patch(complex_patch):
    return numpy.abs(complex_patch)


@pytest.fixture
def make_scene(context):
    """Makes a scene of KEYS with other sections."""

    def make(**changes):
        return sonject.Scene(**{"context": context, **KEYS, **changes})

    return make


@pytest.fixture
def campaign_folder(tmp_path):
    """Makes a folder with CAMPAIGN as campaign.yaml, its scene, and a swath of speckle."""
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN)
    (tmp_path / "scene.yaml").write_text(CAMPAIGN_SCENE)
    numbers = numpy.random.default_rng(7)
    numpy.save(tmp_path / "swath.npy", numbers.rayleigh(0.1, (90, 120)).astype(numpy.float32))
    return tmp_path
