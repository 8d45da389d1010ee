"""Tests of meshes from arrays."""

import numpy
import pytest

import sonject

SIDES = numpy.array([0.6, 0.4, 0.3])  # m
VERTICES = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2 * SIDES
FACES = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def test_a_mesh_of_arrays_is_the_box_that_it_is(amplitude_patch, make_scene, tmp_path):
    scene = make_scene()
    pose = {"material": "steel", "heading": "20 deg"}
    scene["objects[0]"] = {"shape": "mesh", **pose,
                           "mesh": sonject.write_mesh(tmp_path / "box.ply", VERTICES, FACES)}
    mesh = sonject.inject(amplitude_patch, scene).objects[0]
    scene["objects[0]"] = {"shape": "box", "length": SIDES[0], "width": SIDES[1], "height": SIDES[2], **pose}
    box = sonject.inject(amplitude_patch, scene).objects[0]
    for name in ("overall_length_m", "overall_width_m", "overall_height_m", "height_m"):
        assert getattr(mesh, name) == pytest.approx(getattr(box, name), abs=1e-6), name
    # The same rays meet the same faces. Roundings of single precision move a few of some thousand.
    assert mesh.target_strength_db == pytest.approx(box.target_strength_db, abs=0.1)
    assert mesh.shadow == box.shadow


@pytest.mark.parametrize("vertices, faces, name, message", [
    (VERTICES[:, :2], FACES, "a.ply", r"vertices must have rows of three numbers, not the shape \(8, 2\)"),
    (VERTICES, FACES.astype(float), "a.ply", "faces must have rows of three whole numbers"),
    (VERTICES, FACES + 1, "a.ply", "numbers of vertices, 0...7, not 1...8"),
    (VERTICES, FACES - 1, "a.ply", "not -1...6"),
    (VERTICES * numpy.nan, FACES, "a.ply", "finite"),
    (VERTICES, FACES[:0], "a.ply", r"not the shape \(0, 3\)"),
    (VERTICES, FACES, "a.stl", "written as .ply"),
])
def test_what_is_no_mesh_is_refused(vertices, faces, name, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        sonject.write_mesh(tmp_path / name, vertices, faces)
    assert not list(tmp_path.iterdir())
