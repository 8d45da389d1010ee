"""Tests of scenes of dictionaries, arrays and numbers."""

import copy
import math
import os
import pathlib
import pickle

import numpy
import pytest

import sonject
from conftest import COLUMNS, GEOMETRY, KEYS, ROWS
from sonject import keys

TETRAHEDRON = "v 0 0 0\nv 600 0 0\nv 0 600 0\nv 0 0 400\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def image(patch, scene):
    return sonject.inject(patch, scene).image.tobytes()


def test_dictionaries_say_what_a_file_says(tmp_path, context, make_scene, amplitude_patch):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "sonject: 1\n"
        "input: {geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 25 m},\n"
        f"        uniform: {{rows: {ROWS}, columns: {COLUMNS}}}}}\n"
        "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}\n"
        "objects:\n  - {shape: capsule, length: 1 m, diameter: 20 cm, heading: 30 deg, material: rock}\n"
    )
    capsule = {"shape": "capsule", "length": numpy.float64(1), "diameter": "0.2",
               "heading": f"{math.radians(30)} rad", "material": {"name": "rock"}}
    of_file = sonject.Scene.read(path, context=context)
    of_dictionaries = make_scene(objects=[capsule])
    assert image(amplitude_patch, of_dictionaries) == image(amplitude_patch, of_file)
    (tmp_path / "again.yaml").write_text(of_file.text())
    again = sonject.Scene.read(tmp_path / "again.yaml", context=context)
    assert image(amplitude_patch, again) == image(amplitude_patch, of_file)


def test_keys_are_set_one_by_one(make_scene, amplitude_patch):
    scene = make_scene(objects=[])
    assert scene.object_count == 0
    before = image(amplitude_patch, scene)
    scene["objects[0]"] = KEYS["objects"][0]
    scene["objects[1]"] = {"shape": "box", "length": 0.5, "width": 0.4, "height": 0.3}
    assert scene.object_count == 2
    assert image(amplitude_patch, scene) != before
    scene["objects"] = []
    assert image(amplitude_patch, scene) == before
    scene["sonar.altitude"] = 10 + 2**-40
    assert repr(10 + 2**-40) in scene.text()


def test_unknown_keys_are_refused_at_once_and_values_when_used(make_scene, amplitude_patch):
    scene = make_scene()
    with pytest.raises(sonject.SonjectError, match="did you mean 'altitude'") as caught:
        scene["sonar.altitud"] = 3
    assert caught.value.status is sonject.Status.ERROR_INPUT
    scene["objects[0].diameter"] = -1
    with pytest.raises(sonject.SonjectError, match="diameter"):
        sonject.inject(amplitude_patch, scene)


@pytest.mark.parametrize("value", [b"10 m", None, 1j, object(), [{"row": {1, 2}, "column": 1j}]])
def test_values_that_no_file_can_say_are_refused(make_scene, value):
    with pytest.raises(TypeError, match="must be of texts, numbers, lists and dictionaries"):
        make_scene()["sonar.altitude"] = value


def test_layers_and_profiles_are_lists_or_arrays(make_scene, amplitude_patch):
    def with_medium(**medium):
        return image(amplitude_patch, make_scene(medium=medium))

    layers = [{"bottom": 0, "sound_speed": 1490}, {"bottom": 5, "sound_speed": 1520}]
    without, layered = with_medium(), with_medium(layers=layers)
    assert layered != without
    heights, speeds = numpy.linspace(0, 20, 5, dtype=numpy.float32), [1490, 1490, 1500, 1510, 1510]
    assert with_medium(profile={"heights": heights, "sound_speeds": speeds}) not in (without, layered)
    table = make_scene()
    table.set_table("medium.profile.file", height_m=heights, sound_speed_mps=numpy.array(speeds))
    assert image(amplitude_patch, table) == with_medium(
        profile={"heights": list(heights), "sound_speeds": speeds})


def test_tables_that_are_none_are_refused(make_scene):
    scene = make_scene()
    with pytest.raises(TypeError, match="either an array of heights or columns"):
        scene.set_table("sonar.motion.file")
    with pytest.raises(ValueError, match="one length, not along_track_m 2, sway_m 3"):
        scene.set_table("sonar.motion.file", along_track_m=[0, 1], sway_m=[0, 1, 2])
    with pytest.raises(ValueError, match="sway_m must be in one row"):
        scene.set_table("sonar.motion.file", sway_m=[[0, 1]])
    with pytest.raises(TypeError, match="masked"):
        scene.set_table("sonar.motion.file", sway_m=numpy.ma.array([1, 2], mask=[0, 1]))
    with pytest.raises(ValueError, match="rows and columns of real numbers"):
        scene.set_table("seabed.relief[0].heights.file", numpy.zeros((4, 4), complex))
    with pytest.raises(sonject.SonjectError, match="takes no array"):
        scene.set_table("sonar.altitude", x=[1])


def test_the_types_of_keys_know_all_sections():
    assert set(keys.SceneKeys.__annotations__) >= set(KEYS) | {"medium", "seabed", "elements"}
    assert "heading: heading of the nose, from along-track towards range" in keys.Object.__doc__
    assert {"class", "material", "parts"} <= set(keys.Object.__annotations__)


def test_absorption_of_sea_water():
    alpha = sonject.absorption(100e3, 10.0)
    assert alpha == pytest.approx(34e-3, rel=0.02)  # handbooks: 34 dB/km
    assert alpha == sonject.absorption(
        frequency_hz=100e3, temperature_celsius=10, salinity_permille=35, depth_m=0, ph=8)
    assert sonject.absorption(100e3, 10.0, 35.0, 10.0, 7.9) != sonject.absorption(100e3, 10.0, 34.0)
    assert math.isnan(sonject.absorption(2e6, 10.0))
    assert alpha == sonject.absorption("100 kHz", "10 C", depth_m="0 km")
    assert sonject.absorption(1e5, 10, depth_m="2 km") == sonject.absorption(1e5, 10, depth_m=2000)
    with pytest.raises(TypeError, match="frequency_hz must be a number or a text such as '100 kHz', not '100 m'"):
        sonject.absorption("100 m", 10.0)
    with pytest.raises(TypeError, match="ph must be a number, not '8'"):
        sonject.absorption(1e5, 10.0, ph="8")


def test_what_a_scene_says_is_read_back(make_scene, context):
    scene = make_scene(objects=[{**KEYS["objects"][0], "heading": "0.5 rad", "burial": "5 cm"}])
    assert scene["sonar.altitude"] == 10.0 and isinstance(scene["sonar.altitude"], float)
    assert scene["objects[0].heading"] == pytest.approx(math.degrees(0.5), rel=1e-15)
    assert scene["objects[0]"]["burial"] == 0.05 and scene["objects"][0]["name"] == "ball"
    assert list(scene[""]) == ["sonject", "sonar", "input", "objects"]
    scene["sonar.altitude"] = 10 + 2**-40
    assert scene["sonar.altitude"] == 10 + 2**-40
    assert "objects[0].burial" in scene and "objects[1]" not in scene and "medium" not in scene
    with pytest.raises(KeyError, match="medium.sound_speed"):
        scene["medium.sound_speed"]
    with pytest.raises(sonject.SonjectError, match="did you mean 'altitude'"):
        scene["sonar.altitud"]
    with pytest.raises(TypeError, match="key must be a text, not 0"):
        list(scene)
    scene.set_table("sonar.motion.file", along_track_m=[0, 10], sway_m=numpy.array([0, 2e-3]))
    assert scene["sonar.motion.file"] == {"columns": "along_track_m, sway_m",
                                          "values": [[0, 0], [10, 2e-3]]}
    scene["seabed.relief"] = [{"heights": {"unit": "m", "row_spacing": 2}}]
    scene.set_table("seabed.relief[0].heights.file", numpy.full((2, 3), -0.5, numpy.float32))
    assert scene["seabed.relief[0].heights.file"] == {"columns": None, "values": [[-0.5] * 3] * 2}


def test_scenes_that_say_the_same_are_equal(make_scene):
    def with_table(sway_m):
        scene = make_scene()
        scene.set_table("sonar.motion.file", along_track_m=[0, 10], sway_m=sway_m)
        return scene

    assert make_scene() == make_scene(sonar={"altitude": "1000 cm", "bandwidth": "30 kHz", "frequency": 1e5})
    changed = make_scene()
    changed["objects[0].diameter"] = 0.6
    assert changed != make_scene() and make_scene() != KEYS
    assert with_table([0, 1]) == with_table([0, 1]) != with_table([0, 2]) != make_scene()
    with pytest.raises(TypeError, match="unhashable"):
        hash(changed)


def test_contexts_close_scenes_that_are_equal():
    context = sonject.Context()
    scenes = [sonject.Scene(context=context, **KEYS) for _ in range(2)]
    context.close()
    for scene in scenes:
        with pytest.raises(ValueError, match="scene was closed"):
            scene.text()


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda each: pickle.loads(pickle.dumps(each))])
def test_a_copy_is_a_scene_of_its_own(make_scene, amplitude_patch, duplicate):
    scene = make_scene(objects=[{"shape": "sphere", "diameter": 0.5, "heading": "0.35 rad"}])
    before = image(amplitude_patch, scene)
    other = duplicate(scene)
    assert other == scene and image(amplitude_patch, other) == before
    assert (other.context is scene.context) == (duplicate in (copy.copy, copy.deepcopy))
    other["objects[0].diameter"] = 0.4
    assert other != scene and image(amplitude_patch, other) != before
    assert image(amplitude_patch, scene) == before


def test_a_scene_is_written_for_other_folders(tmp_path, context, amplitude_patch, monkeypatch):
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    (tmp_path / "here" / "a.obj").write_text(TETRAHEDRON)
    (tmp_path / "here" / "scene.yaml").write_text(
        f"sonject: 1\ninput: {{geometry: {GEOMETRY}, uniform: {{rows: {ROWS}, columns: {COLUMNS}}}}}\n"
        "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}\n"
        "objects: [{shape: mesh, mesh: {file: a.obj, unit: mm}}]\n")
    monkeypatch.chdir(tmp_path / "here")
    scene = sonject.Scene.read("scene.yaml", context=context)
    scene["objects[1]"] = {"shape": "mesh", "mesh": {"file": "a.obj", "unit": "mm"}, "heading": 90}
    before = image(amplitude_patch, scene)
    pickled, written = pickle.dumps(scene), tmp_path / "there" / "scene.yaml"
    scene.write(written)
    monkeypatch.chdir("/")
    for other in (sonject.Scene.read(written, context=context), pickle.loads(pickled)):
        assert image(amplitude_patch, other) == before
        assert pathlib.Path(other["objects[1].mesh.file"]) == tmp_path / "here" / "a.obj"
    assert [path.name for path in written.parent.iterdir()] == ["scene.yaml"]


def test_a_scene_keeps_its_image_when_the_working_directory_changes(tmp_path, context, monkeypatch):
    for line in (1, 2):
        (tmp_path / f"line_{line}").mkdir()
        monkeypatch.chdir(tmp_path / f"line_{line}")
        numpy.save("swath.npy", numpy.full((ROWS, COLUMNS), line, numpy.float32))
    pathlib.Path(tmp_path / "line_1" / "scene.yaml").write_text(
        f"sonject: 1\ninput: {{path: swath.npy, geometry: {GEOMETRY}}}\n"
        "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}\n")
    monkeypatch.chdir(tmp_path / "line_1")
    scene = sonject.Scene.read("scene.yaml", context=context)
    monkeypatch.chdir(tmp_path / "line_2")
    sonject.run(scene, "out")
    assert numpy.load("out/image.npy").max() == 1
    assert scene["input.path"] == str(tmp_path / "line_1" / "swath.npy")


def test_a_scene_is_written_whole_or_not_at_all(make_scene, tmp_path, monkeypatch):
    path = tmp_path / "scene.yaml"
    path.write_text("before")
    scene = make_scene()
    with pytest.raises(OSError):
        scene.write(tmp_path / "none" / "scene.yaml")

    def fail(_descriptor):
        raise OSError("the disk is full")

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", fail)
        with pytest.raises(OSError, match="full"):
            scene.write(path)
    scene.set_table("sonar.motion.file", along_track_m=[0, 10], sway_m=[0, 2e-3])
    for refuse in (lambda: scene.write(path), lambda: pickle.dumps(scene), lambda: copy.copy(scene)):
        with pytest.raises(ValueError, match="^sonar.motion.file is a table in memory, which .* cannot"):
            refuse()
    assert path.read_text() == "before" and list(tmp_path.iterdir()) == [path]
    scene["sonar.motion"] = {}
    scene.write(path)
    assert path.read_text() == scene.text()
