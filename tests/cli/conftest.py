"""Fixtures and helpers of the command's tests. SONJECT_COMMAND names the command."""

import json
import os
import pathlib
import subprocess

import numpy
import pytest

import images

ROWS, COLUMNS = 96, 128

SCENE = """\
sonject: 1
input:
  path: swath.tif
  geometry:
    row_spacing: 2.5 cm
    column_spacing: 2.5 cm
    first_slant_range: 25 m
sonar:
  frequency: 100 kHz
  bandwidth: 30 kHz
  altitude: 10 m
objects:
  - name: ball
    shape: sphere
    diameter: 0.5 m
"""


def pytest_sessionstart(session):
    if not os.environ.get("SONJECT_COMMAND"):
        raise pytest.UsageError("set SONJECT_COMMAND to the path of the command")


COMMAND = os.environ.get("SONJECT_COMMAND", "")


@pytest.fixture(scope="session")
def environment(tmp_path_factory):
    """Returns the environment of commands. The home is new, but the cache of compiled kernels is the
    tester's, since compiling them takes longest."""
    caches = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    home = tmp_path_factory.mktemp("home")
    return {**os.environ, "HOME": str(home), "XDG_CACHE_HOME": str(caches)}


@pytest.fixture
def sonject(tmp_path, environment):
    """Runs the command in a new folder. changes: environment variables, of which None removes one.
    sonject.done also asserts success."""

    def run(*arguments, changes=None, timeout=300, folder=".", **options):
        variables = {**environment, **(changes or {})}
        variables = {name: value for name, value in variables.items() if value is not None}
        options.setdefault("stdout", subprocess.PIPE)
        options.setdefault("stderr", subprocess.PIPE)
        return subprocess.run(
            [COMMAND, *map(str, arguments)],
            cwd=tmp_path / folder,
            env=variables,
            text=True,
            timeout=timeout,
            **options,
        )

    def done(*arguments, **options):
        answer = run(*arguments, **options)
        assert answer.returncode == 0, answer.stderr
        return answer

    run.done = done
    return run


def make_swath():
    """Returns Rayleigh amplitudes with an rms of 0.1."""
    random = numpy.random.default_rng(20240502)
    return random.rayleigh(0.1 / numpy.sqrt(2), (ROWS, COLUMNS)).astype(numpy.float32)


@pytest.fixture
def swath():
    return make_swath()


@pytest.fixture
def sides(request):
    """Returns samples of port and starboard, ROWS x COLUMNS of the test's module each."""
    random, size = numpy.random.default_rng(7), (request.module.ROWS, request.module.COLUMNS)
    return [random.rayleigh(2000.0, size).astype(numpy.uint16) for _ in range(2)]


def write_scene(folder, swath):
    """Writes a scene file with a sphere on a float32 swath and returns its path."""
    (folder / "swath.tif").write_bytes(images.tiff_bytes(swath))
    path = folder / "scene.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def scene(tmp_path, swath):
    return write_scene(tmp_path, swath)


def write_text(folder, source, geometry, objects="", altitude="10 m", sonar="frequency: 100 kHz, bandwidth: 30 kHz", more=""):
    """Writes scene.yaml in flow style. source: the keys of the input but for its geometry. more: other sections."""
    (folder / "scene.yaml").write_text(
        f"sonject: 1\ninput: {{{source}, geometry: {{{geometry}}}}}\nsonar: {{{sonar}, altitude: {altitude}}}\n"
        f"objects: [{objects}]\n{more}")


def files_below(folder):
    """Returns all files below the folder, or none if the folder is missing. Commands may be writing there."""
    return sorted(pathlib.Path(place, name) for place, _, names in os.walk(folder) for name in names)


def page_data(folder, name="report.html"):
    """Returns the data that the folder's page shows."""
    page = (folder / name).read_text(encoding="utf-8")
    return json.loads(page.split('<script type="application/json" id="data">')[1].split("</script>")[0])


def assert_refused(answer, code, *words, mistakes=1):
    """Asserts the exit code, one line on stderr for each mistake, and nothing on stdout. The first line
    has the words."""
    assert answer.returncode == code, answer.stderr
    lines = answer.stderr.splitlines()
    assert len(lines) == mistakes, answer.stderr
    assert all(line.startswith("sonject: ") for line in lines)
    for word in words:
        assert word in lines[0], (word, lines[0])
    assert not answer.stdout
