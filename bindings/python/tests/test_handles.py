"""Lifetimes, files and the remaining calls."""

import os
import subprocess
import sys

import pytest

import sonject
from conftest import PACKAGE_FOLDER


def test_version_is_the_packages():
    assert sonject.version().split(".")[0] == "0"


def test_devices_have_names_and_one_default(context):
    devices = context.devices()
    assert devices
    assert [device.is_default for device in devices].count(True) == 1
    assert all(device.name and device.compute_units > 0 for device in devices)


def test_closing_the_context_closes_what_it_made(amplitude_patch):
    context = sonject.Context(cache_folder="")
    scene = sonject.Scene(
        geometry=sonject.Geometry(first_slant_range_m=25.0),
        objects=[sonject.Sphere(diameter_m=0.5)],
        context=context,
    )
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


def test_a_forked_process_is_told_that_it_cannot(context):
    child = os.fork()
    if child == 0:
        code = 1
        try:
            with pytest.raises(RuntimeError, match="parent process"):
                context.devices()
            with pytest.raises(RuntimeError, match="spawn processes"):
                sonject.devices()
            code = 0
        finally:  # whatever is raised must not go on as a second run of the tests
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


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


def test_objects_are_counted(make_scene):
    scene = make_scene(objects=[])
    assert scene.object_count == 0
    assert scene.add(sonject.Plane(length_m=1, width_m=1)) == 0
    assert scene.add(sonject.Cylinder(length_m=1, diameter_m=0.2)) == 1
    assert scene.object_count == 2
    with pytest.raises(TypeError, match="an Object is wanted"):
        scene.add("sphere")


def test_log_errors_are_raised(amplitude_patch, make_scene):
    lines = []

    def log(line):
        lines.append(line)
        raise LookupError("from the log")

    with sonject.Context(cache_folder="", log=log) as context:
        scene = make_scene(context=context)
        try:
            sonject.inject(amplitude_patch, scene)
        except LookupError as error:
            assert "from the log" in str(error)
        assert lines and all(isinstance(line, str) for line in lines)


def test_the_log_tells_device_programs_and_noise_floor(amplitude_patch, make_scene):
    lines = []
    with sonject.Context(cache_folder="", log=lines.append) as context:
        sonject.inject(amplitude_patch, make_scene(context=context))
    assert [line for line in lines if line.startswith("device '")] == lines[:1]
    assert any("trace_rough.cl built in" in line for line in lines)
    assert lines[-1].startswith("noise floor estimated")
    assert not any("\n" in line for line in lines)


def run_python(code, **environment):
    variables = {**os.environ, "PYTHONPATH": str(PACKAGE_FOLDER), **environment}
    return subprocess.run(
        [sys.executable, "-c", code], env=variables, capture_output=True, text=True
    )


def test_a_missing_library_is_explained():
    answer = run_python(
        "import sonject; sonject.version()", SONJECT_LIBRARY="/nonexistent/libsonject.so"
    )
    assert answer.returncode == 1
    assert "ImportError: libsonject was not found: set the environment variable" in answer.stderr


def test_an_interpreter_ends_quietly_with_everything_alive():
    answer = run_python(
        "import numpy, sonject\n"
        "scene = sonject.Scene(geometry=sonject.Geometry(first_slant_range_m=25.0),\n"
        "                      objects=[sonject.Sphere(diameter_m=0.5)])\n"
        "result = sonject.inject(numpy.ones((64, 64), numpy.float32), scene)\n"
        "result.image, result.objects, result.statistics\n"
    )
    assert (answer.returncode, answer.stderr) == (0, "")
