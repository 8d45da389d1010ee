"""Tests of bindings/matlab in Octave: image, masks and truth are the command's, errors are its messages."""

import json
import re
import subprocess

import numpy
import pytest

import images
import recordings
from conftest import COMMAND
from documents import SOURCE, blocks

SAVED = "save('-v6', 'saved.mat', 'image', 'truth', 'masks');\n"
OF_ARRAYS = """
scene.sonar = struct('frequency', '100 kHz', 'bandwidth', '30 kHz', 'altitude', '10 m');
scene.input.geometry = struct('row_spacing', '2.5 cm', 'column_spacing', '2.5 cm', 'first_slant_range', '25 m');
scene.input.transfer.kind = 'amplitude';
scene.objects = {struct('name', 'b\u00e4ll', 'shape', 'sphere', 'diameter', 0.5)};
"""
SCENE = """\
sonject: 1
input:
  path: %s
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 25 m}
  transfer: {kind: amplitude}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}
objects: [{name: b\u00e4ll, shape: sphere, diameter: 0.5}]
"""


@pytest.fixture
def octave(tmp_path, environment, monkeypatch):
    """Runs a program in the test's folder and returns its output. Asserts that no temporary folder is left."""
    temporary = tmp_path / "it's temporary"
    temporary.mkdir()

    def run(program, folder=tmp_path):
        answer = subprocess.run(
            ["octave-cli", "--no-init-file", "--no-history", "--path", SOURCE / "bindings" / "matlab", "--eval", program],
            cwd=folder, env={**environment, "TMPDIR": str(temporary)}, check=False, capture_output=True, text=True)
        assert answer.returncode == 0, answer.stderr
        assert list(temporary.iterdir()) == []
        return answer.stdout + answer.stderr

    return run


def saved(folder):
    from scipy.io import loadmat

    return loadmat(folder / "saved.mat", squeeze_me=True, struct_as_record=False)


def image_of(path):
    from PIL import Image

    return numpy.asarray(Image.open(path))


def assert_same_masks(masks, folder):
    for name in ("labels", "highlight", "shadow", "influence"):
        expected = image_of(folder / f"{name}.png")
        assert expected.any()
        mask = getattr(masks, name)
        # a mask may be read as one bit or as 255
        assert numpy.array_equal(mask, expected if name == "labels" else expected != 0), name


def test_a_scene_gives_what_the_command_gives(octave, sonject, tmp_path):
    demo = SOURCE / "tools" / "scenes" / "demo.yaml"
    octave(f"[image, truth, masks] = sonject([], '{demo}', 'objects[0].heading', '90 deg', 'injection.seed', 7);" + SAVED)
    sonject.done("run", demo, "-o", "out", "--set", "objects[0].heading=90 deg", "--seed", 7)
    found = saved(tmp_path)
    expected = image_of(tmp_path / "out" / "image.tif")
    assert found["image"].dtype == numpy.float32 and found["image"].tobytes() == expected.tobytes()
    assert_same_masks(found["masks"], tmp_path / "out")
    truth = json.loads((tmp_path / "out" / "truth.json").read_text())
    assert len(found["truth"].objects) == len(truth["objects"]) == 3
    for one, other in zip(found["truth"].objects, truth["objects"]):
        assert (one.name, one.id, one.pose.heading_deg) == (other["name"], other["id"], other["pose"]["heading_deg"])
        assert one.target_strength_db == other["target_strength_db"]
        assert vars(one.box)["column"] == other["box"]["column"]


@pytest.mark.parametrize("samples, scale", [
    ("float32", 1), ("float64", 1), ("uint8", 100), ("uint16", 10000), ("int16", 10000), ("complex64", 1 + 1j)])
def test_an_array_gives_what_command_and_python_give(octave, sonject, swath, tmp_path, samples, scale):
    from scipy.io import loadmat, savemat

    pixels = (swath * scale).astype(samples)
    savemat(tmp_path / "swath.mat", {"pixels": pixels})
    octave("load swath.mat" + OF_ARRAYS + "[image, truth, masks] = sonject(pixels, scene);" + SAVED)
    (tmp_path / "scene.yaml").write_text(SCENE % "swath.mat", encoding="utf-8")
    sonject.done("run", "scene.yaml", "-o", "out", "--set", f"input.complex={str(samples == 'complex64').lower()}")
    expected = loadmat(tmp_path / "out" / "image.mat")["pixels"]
    found = saved(tmp_path)
    assert not numpy.array_equal(expected, pixels) and numpy.array_equal(found["image"], expected)
    assert_same_masks(found["masks"], tmp_path / "out")
    assert found["truth"].objects.name == "b\u00e4ll"
    if numpy.dtype(samples).kind in "fc":  # Python takes amplitudes alone
        import sonject as package

        result = package.inject(pixels, package.Scene.read(tmp_path / "scene.yaml"))
        assert numpy.array_equal(found["image"], result.image) and numpy.array_equal(found["masks"].labels, result.labels)


@pytest.mark.parametrize("name", ["swath.tif", "swath.npy", "swath.png"])
def test_files_are_read_from_the_current_folder(octave, sonject, swath, tmp_path, name):
    (tmp_path / "swath.tif").write_bytes(images.tiff_bytes(swath))
    if name == "swath.png":
        (tmp_path / "swath.tif").write_bytes(images.tiff_bytes((swath * 10000).astype(numpy.uint16)))
    if name != "swath.tif":
        sonject.done("convert", "swath.tif", name)
    octave(OF_ARRAYS + f"[image, truth, masks] = sonject('{name}', scene);" + SAVED)
    (tmp_path / "scene.yaml").write_text(SCENE % name, encoding="utf-8")
    sonject.done("run", "scene.yaml", "-o", "out")
    written = tmp_path / "out" / f"image{name[-4:]}"
    expected = numpy.load(written) if name == "swath.npy" else image_of(written)
    assert numpy.array_equal(saved(tmp_path)["image"], expected)


def test_mistakes_are_errors_with_the_commands_lines(octave, scene, tmp_path):
    caught = "catch failure, disp(failure.identifier), disp(failure.message), end\n"
    said = octave(f"try, sonject([], '{scene}', 'sonar.altitud', 3, 'objects[0].diameter', '1 kg'), {caught}"
                  f"try, sonject(ones(3, 'int32'), '{scene}'), {caught}"
                  f"try, sonject([], '{scene}', 'bands', struct('low', struct())), {caught}"
                  f"setenv('SONJECT_COMMAND', 'no such command'), try, sonject([], '{scene}'), {caught}").splitlines()
    assert said[:3] == ["sonject:scene", "sonject: --set sonar.altitud: unknown key; did you mean 'altitude'?",
                        "sonject: --set objects[0].diameter: unit 'kg' is not one of m, km, cm, mm"]
    assert said[3] == "sonject:scene" and "save it as double, single" in said[4]
    assert said[5:7] == ["sonject:bands", "the scene has bands: choose one by the key 'band'"]
    assert said[7] == "sonject:failed" and "no such command" in said[8] and "(exit code 127)" in said[8]


def test_a_recording_is_refused(octave, scene, tmp_path):
    samples = numpy.full((96, 128), 100, "<u2")
    (tmp_path / "line.xtf").write_bytes(recordings.xtf_bytes(samples, samples))
    said = octave(f"try, sonject('line.xtf', '{scene}', 'input.channel', 'port', 'input.transfer.kind', 'amplitude', "
                  "'injection.noise_floor', '-18 dB', 'input.geometry', 'from_file', 'sonar.altitude', '10 m'), "
                  "catch failure, disp(failure.message), end")
    assert said == "the image is written as .xtf, which is not read here: run the command\n"


def test_notes_are_warnings(octave, scene):
    said = octave(f"sonject([], '{scene}', 'objects[0].diameter', '10 cm', 'objects[0].burial', '9 cm', "
                  "'objects[0].level.target_strength', '-120 dB', 'injection.noise_floor', '-18 dB');")
    assert said.startswith("warning: 'ball' cannot be seen: ") and "note" not in said


def test_the_programs_of_page_and_help_run(octave, tmp_path):
    (program,) = blocks("docs/embedding.md", "matlab")
    for name in ("bindings", "tools"):
        (tmp_path / name).symlink_to(SOURCE / name)
    said = octave(program.replace("build/tools/sonject", COMMAND) + "disp(size(image)), disp(fieldnames(masks)')")
    assert re.search(r"200 +320\n", said) and "labels" in said
    text = (SOURCE / "bindings" / "matlab" / "sonject.m").read_text(encoding="utf-8")
    example = re.search(r"%   Example:\n((?:%      .*\n)+)", text).group(1)
    strength, pixels = map(float, octave(re.sub(r"^%", "", example, flags=re.M)).split())
    assert -40 < strength < 0 < pixels
