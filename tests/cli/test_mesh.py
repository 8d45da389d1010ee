"""Tests of the command's messages about meshes in scenes."""

import pytest

from conftest import SCENE, assert_refused

TETRAHEDRON = """\
v 0 0 0
v 600 0 0
v 0 500 0
v 0 0 400
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""

OBJECTS = """\
objects:
  - {name: one, shape: mesh, mesh: {file: shapes/rock.obj, unit: mm}}
  - {name: other, shape: mesh, mesh: {file: shapes/rock.obj, unit: mm},
     position: {row: 20, column: 30}, heading: 90 deg}
"""


@pytest.fixture
def mesh(tmp_path, scene):
    """Writes the mesh that the scene shows twice and returns its path."""
    scene.write_text(SCENE[: SCENE.index("objects:")] + OBJECTS)
    (tmp_path / "shapes").mkdir()
    path = tmp_path / "shapes" / "rock.obj"
    path.write_text(TETRAHEDRON)
    return path


def test_check_describes_meshes(sonject, scene, mesh):
    answer = sonject.done("check", scene)
    assert "shapes/rock.obj: 4 triangles, 0.6 x 0.5 x 0.4 m, shown 2 times\n" in answer.stdout
    assert "watertight, 0.02 m3, 1 piece\n" in answer.stdout
    mesh.write_text(TETRAHEDRON.replace("f 2 3 4\n", ""))
    assert_refused(sonject("check", scene), 3, "scene.yaml:13:43", "rock.obj", "enclose a volume")
    scene.write_text(scene.read_text().replace("unit: mm", "unit: mm, open: true"))
    answer = sonject.done("check", scene)
    assert "not watertight, thin sheets: 3 edges of one triangle" in answer.stdout
