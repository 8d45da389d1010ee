"""Scenes of dictionaries, arrays and numbers."""

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

CELL = 1500.0 / (2.0 * 30e3)  # range resolution, m
TETRAHEDRON = "v 0 0 0\nv 600 0 0\nv 0 600 0\nv 0 0 400\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
SPHERE = """
float shape_distance(float3 p, float3 d, float nearest, const float *a)
{
    const float square = a[0] * a[0] - dot(p, p);
    if (square < 0.0f)
        return INFINITY;
    return -sqrt(square) > nearest ? -sqrt(square) : sqrt(square) > nearest ? sqrt(square) : INFINITY;
}
float3 shape_normal(float3 p, const float *a)
{
    return p;
}
"""


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
    for key, value, match in (
        ("sonar.altitud", 3, "did you mean 'altitude'"),
        ("sonar", {"altitud": 3}, "did you mean 'altitude'"),
        ("objects[7]", {}, r"\[1\] would add one"),
    ):
        with pytest.raises(sonject.SonjectError, match=match) as caught:
            scene[key] = value
        assert caught.value.status is sonject.Status.ERROR_INPUT
    scene["objects[0].diameter"] = -1
    scene["sonar.kind"] = "towed"
    with pytest.raises(sonject.SonjectError) as caught:
        sonject.inject(amplitude_patch, scene)
    told = str(caught.value).splitlines()
    assert len(told) == 2 and "diameter" in told[0] + told[1] and "synthetic, real" in told[0] + told[1]
    with pytest.raises(sonject.SonjectError, match="frequency: missing"):
        sonject.Scene(input={"geometry": GEOMETRY}, sonar={"bandwidth": 30e3, "altitude": 10})


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


def gaussian(ranges_m):
    return numpy.exp(-2.0 * numpy.log(2.0) * (ranges_m / CELL) ** 2)


def test_a_table_of_the_default_pulse_changes_nothing_much(make_scene, amplitude_patch):
    ranges_m = numpy.arange(-40, 41) * CELL / 8.0
    injection = {"match": {"response": "nominal"}}  # tables are taken as they are
    expected = sonject.inject(amplitude_patch, make_scene(injection=injection)).field
    fields = []
    for columns in ({"range_m": ranges_m, "real": 0 * ranges_m, "imaginary": 3 * gaussian(ranges_m)},
                    {"time_s": ranges_m / 750.0, "real": gaussian(ranges_m)}):
        scene = make_scene(injection=injection)
        scene["sonar.pulse.kind"] = "table"
        scene.set_table("sonar.pulse.file", **columns)
        fields.append(sonject.inject(amplitude_patch, scene).field)
    by_range, by_time = fields
    changed = (expected != 0) & (by_range != 0) & (by_time != 0)
    assert changed.sum() > 0.95 * (expected != 0).sum() > 100
    # the cubic between eight samples a cell errs by 1e-4 of the brightest pixel
    largest = numpy.abs(expected).max()
    assert numpy.abs(by_range - expected)[changed].max() < 2e-3 * largest
    assert numpy.abs(by_time - by_range)[changed].max() < 1e-5 * largest


@pytest.mark.parametrize("key, columns", [
    ("sonar.motion.file", {"along_track_m": [-10, 0, 10], "sway_m": [0, 2e-3, 0]}),
    ("sonar.motion.yaw.file", {"along_track_m": [-10, 10], "yaw_rad": [2e-3, 2e-3]}),
    ("sonar.measured_response", {"along_track_m": numpy.arange(-20, 21) * 0.01,
                                 "real": numpy.exp(-0.5 * (numpy.arange(-20, 21) / 3) ** 2)}),
])
def test_tables_change_the_target(make_scene, amplitude_patch, key, columns):
    scene = make_scene()
    plain = image(amplitude_patch, scene)
    if "yaw" in key:
        scene["sonar.motion.yaw.advance"] = 0.4
        assert image(amplitude_patch, scene) == plain
    scene.set_table(key, **columns)
    assert image(amplitude_patch, scene) != plain


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


RELIEF = {"unit": "m", "row_spacing": 0.025, "column_spacing": 0.025, "first_ground_range": 22.9}


def test_heights_change_the_image_where_they_are(make_scene, amplitude_patch):
    along, out = numpy.meshgrid(numpy.arange(96) * 0.025, 22.9 + numpy.arange(150) * 0.025, indexing="ij")
    distance = numpy.hypot(along - 1.2, out - 24.5) / 0.5
    mound = numpy.where(distance < 1, 0.1 * (1 + numpy.cos(numpy.pi * distance)), 0)
    scene = make_scene(objects=[])
    scene["seabed.relief"] = [{"heights": RELIEF}]
    scene.set_table("seabed.relief[0].heights.file", mound)
    result = sonject.inject(amplitude_patch, scene)
    assert result.visibility.max() > 1.5 and result.visibility.min() < 0.5
    untouched = result.influence == 0
    assert untouched.sum() > 2000
    assert numpy.array_equal(result.image[untouched], amplitude_patch[untouched])
    scene["objects"] = KEYS["objects"]
    level = sonject.inject(amplitude_patch, make_scene()).objects[0]
    scene.set_table("seabed.relief[0].heights.file", numpy.full((97, 150), -0.1))
    lowered = sonject.inject(amplitude_patch, scene).objects[0]
    assert lowered.height_m == pytest.approx(level.height_m - 0.1, abs=1e-4)
    scene.set_table("seabed.relief[0].heights.file", 20 * mound)
    with pytest.raises(sonject.SonjectError, match="rises by"):
        sonject.inject(amplitude_patch, scene)


def test_meshes_are_files(make_scene, amplitude_patch, tmp_path):
    path = tmp_path / "tetrahedron.obj"
    path.write_text(TETRAHEDRON)
    mesh = {"shape": "mesh", "mesh": {"file": path, "unit": "mm", "nose": "y"}}
    truth = sonject.inject(amplitude_patch, make_scene(objects=[mesh])).objects[0]
    assert truth.highlight_pixels > 0
    assert abs(truth.height_m - 0.2) < 1e-6  # it rests on the seabed
    buried = mesh | {"burial": {"fraction": 0.5}}
    truth = sonject.inject(amplitude_patch, make_scene(objects=[buried])).objects[0]
    assert abs(truth.height_m) < 1e-6


def test_shapes_by_code_need_consent(make_scene, amplitude_patch):
    shape = {"shape": "user", "user": {"code": SPHERE, "bounding_radius": 0.25, "parameters": [0.25]}}
    with pytest.raises(sonject.SonjectError, match="code that would run with your rights"):
        make_scene(objects=[shape])
    scene = make_scene(objects=[shape], allows_user_shapes=True)
    ours, theirs = (sonject.inject(amplitude_patch, each).objects[0] for each in (scene, make_scene()))
    # the same rough part, but glints of the sphere have wider cells
    assert abs(ours.target_strength_db - theirs.target_strength_db) < 0.01
    assert ours.highlight_pixels == pytest.approx(theirs.highlight_pixels, rel=0.02)


def test_the_types_of_keys_know_all_sections():
    assert set(keys.SceneKeys.__annotations__) >= set(KEYS) | {"medium", "seabed", "elements"}
    assert "heading: from along-track towards range" in keys.Object.__doc__
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
    scene.set_table("sonar.motion.file", along_track_m=[0, 10], sway_m=[0, 2e-3])
    assert scene["sonar.motion.file"] == {"columns": "along_track_m, sway_m",
                                          "values": [[0, 0], [10, 2e-3]]}


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
    shape = {"shape": "user", "user": {"code": SPHERE, "bounding_radius": 0.25, "parameters": [0.25]},
             "heading": "0.35 rad"}
    scene = make_scene(objects=[shape], allows_user_shapes=True)
    before = image(amplitude_patch, scene)
    other = duplicate(scene)
    assert other == scene and image(amplitude_patch, other) == before
    assert (other.context is scene.context) == (duplicate in (copy.copy, copy.deepcopy))
    other["objects[0].user.parameters"] = [0.2]
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
        assert other["objects[1].mesh.file"] == str(tmp_path / "here" / "a.obj")
    assert [path.name for path in written.parent.iterdir()] == ["scene.yaml"]


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
