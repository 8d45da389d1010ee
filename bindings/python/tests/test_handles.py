"""Lifetimes, files and the remaining calls."""

import os
import re
import subprocess
import sys

import pytest

import sonject
from sonject._values import override_texts
from conftest import KEYS, PACKAGE


def test_version_is_the_packages():
    assert sonject.version().split(".")[0] == "0"
    assert sonject.__version__ == sonject.version()


def test_devices_have_names_and_one_default(context):
    devices = context.devices()
    assert devices
    assert [device.is_default for device in devices].count(True) == 1
    assert all(device.name and device.compute_units > 0 for device in devices)


def test_closing_the_context_closes_what_it_made(amplitude_patch):
    context = sonject.Context()
    scene = sonject.Scene(**KEYS, context=context)
    result = sonject.inject(amplitude_patch, scene)
    image = result.image
    context.close()
    context.close()
    assert result.image is image
    with pytest.raises(ValueError, match="result was closed"):
        result.field
    with pytest.raises(ValueError, match="scene was closed"):
        scene.object_count
    with pytest.raises(ValueError, match="context was closed"):
        context.devices()


def test_scene_files_report_their_line(tmp_path, context):
    path = tmp_path / "scene.yaml"
    path.write_text("sonject: 1\nbogus: 1\n")
    with pytest.raises(sonject.SonjectError) as caught:
        sonject.Scene.read(path, context=context)
    assert caught.value.status is sonject.Status.ERROR_INPUT
    assert "scene.yaml:2:1" in str(caught.value)
    assert "bogus" in str(caught.value)


def test_a_missing_scene_file_is_named(tmp_path, context):
    with pytest.raises(sonject.SonjectError, match="absent.yaml"):
        sonject.Scene.read(tmp_path / "absent.yaml", context=context)
    with pytest.raises(ValueError, match="NUL"):
        sonject.Scene.read("a\0b", context=context)


def test_overrides_are_texts_or_a_mapping(context):
    with pytest.raises(TypeError, match="overrides"):
        sonject.Scene.read("scene.yaml", overrides="injection.seed=1", context=context)
    values = {"injection.order_energies": True, "sonar": {"altitude": 10}, "sonar.bandwidth": "30 kHz"}
    assert list(override_texts(values)) == [b"injection.order_energies=true", b'sonar={"altitude": 10}',
                                            b"sonar.bandwidth=30 kHz"]


def test_log_errors_are_raised(amplitude_patch, make_scene):
    lines = []

    def log(level, line):
        lines.append(line)
        raise LookupError("from the log")

    with sonject.Context(log=log) as context:
        scene = make_scene(context=context)
        try:
            sonject.inject(amplitude_patch, scene)
        except LookupError as error:
            assert "from the log" in str(error)
        assert lines and all(isinstance(line, str) for line in lines)


def test_the_log_tells_device_programs_and_noise_floor_and_progress_the_compiling(tmp_path):
    # in its own process no other context holds the programs, and the driver has no cache
    answer = run_python(
        "import numpy, sonject, sys\n"
        "with sonject.Context(device='pthread', log=lambda level, line: print(line)) as context:\n"
        f"    scene = sonject.Scene(**{KEYS}, context=context)\n"
        "    patch = numpy.random.default_rng(1).rayleigh(size=(64, 64)).astype(numpy.float32)\n"
        "    sonject.inject(patch, scene, lambda fraction, stage: print(stage, file=sys.stderr))\n",
        POCL_CACHE_DIR=str(tmp_path),
    )
    assert re.search(r"^compiling, once: \d+ s$", answer.stderr, re.M)
    lines = answer.stdout.splitlines()
    assert [line for line in lines if line.startswith("device '")] == lines[:1]
    assert any("trace_rough.cl built in" in line for line in lines)
    assert lines[-1].startswith("no shadow in the patch shows the noise floor")


@pytest.mark.parametrize("log, is_printed", [
    ("None", True), ("lambda level, line: None", False),
    ("lambda level, line: level < logging.WARNING or print(line, file=sys.stderr)", True)])
def test_notes_are_printed_unless_a_log_takes_them(log, is_printed, tmp_path):
    """This holds for inject and run alike; lines of mere news are not printed."""
    answer = run_python(
        "import logging, numpy, sonject, sys\n"
        f"with sonject.Context(log={log}) as context:\n"
        f"    scene = sonject.Scene(**{KEYS}, context=context)\n"
        "    scene['objects[0].level.over_seabed'] = '33 dB'\n"
        "    scene['injection.noise_floor'] = '-25 dB'\n"
        "    patch = numpy.random.default_rng(1).rayleigh(50, size=(96, 128)).astype(numpy.uint8)\n"
        "    sonject.inject(patch, scene, transfer='{kind: amplitude}')\n"
        f"    numpy.save('{tmp_path.as_posix()}/swath.npy', patch)\n"
        f"    scene['input.path'] = '{tmp_path.as_posix()}/swath.npy'\n"
        f"    sonject.run(scene, '{tmp_path.as_posix()}/out')\n"
    )
    assert answer.returncode == 0, answer.stderr
    lines = answer.stderr.splitlines()
    assert len(lines) == 2 * is_printed
    assert all("of the highlight of 'ball' is cut at the image's ceiling" in line for line in lines)


def run_python(code, **environment):
    variables = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), **environment}
    return subprocess.run(
        [sys.executable, "-c", code], env=variables, capture_output=True, text=True
    )


def test_a_missing_library_is_explained():
    answer = run_python(
        "import sonject; sonject.version()", SONJECT_LIBRARY="/nonexistent/libsonject.so"
    )
    assert answer.returncode == 1
    assert "ImportError: libsonject was not found: set the environment variable" in answer.stderr


def test_the_module_is_the_command_of_a_wheel():
    """A package that was not installed lacks the command, and says so in a line."""
    answer = run_python("import runpy, sys\nsys.argv = ['sonject', '--version']\nrunpy.run_module('sonject', run_name='__main__')")
    if (PACKAGE / "sonject").exists() or (PACKAGE / "sonject.exe").exists():
        assert (answer.returncode, answer.stdout) == (0, f"sonject {sonject.__version__}\n")
    else:
        assert answer.returncode == 1 and answer.stderr.count("\n") == 1
        assert f"{PACKAGE / 'sonject'} cannot be run" in answer.stderr and "wheel" in answer.stderr


def test_an_interpreter_ends_quietly_with_everything_alive():
    answer = run_python(
        "import numpy, sonject\n"
        f"scene = sonject.Scene(**{KEYS})\n"
        "result = sonject.inject(numpy.ones((64, 64), numpy.float32), scene)\n"
        "result.image, result.objects, result.statistics\n"
    )
    assert (answer.returncode, answer.stderr) == (0, "")
