"""Scenes whose shapes are code: consent, errors with the user's lines, the check, and a run."""

import json

import numpy
import pytest

from conftest import assert_refused, files_below
import images

SPHERE = """\
/* A sphere about the origin. */
float shape_distance(float3 p, float3 d, float nearest, const float *a)
{
    const float square = a[0] * a[0] - dot(p, p);
    if (square < 0.0f)
        return INFINITY;
    const float half_chord = sqrt(square);
    return -half_chord > nearest ? -half_chord : half_chord > nearest ? half_chord : INFINITY;
}

float3 shape_normal(float3 p, const float *a)
{
    return p;
}
"""
ALLOW = "--allow-user-shapes"


@pytest.fixture
def user_scene(scene):
    """The scene with its sphere by code."""
    (scene.parent / "ball.cl").write_text(SPHERE)
    text = scene.read_text().replace(
        "    shape: sphere\n    diameter: 0.5 m\n",
        "    shape: user\n    user: {file: ball.cl, bounding_radius: 25 cm, parameters: [0.25]}\n",
    )
    assert "shape: user" in text
    path = scene.parent / "user.yaml"
    path.write_text(text)
    return path


def test_code_needs_consent(sonject, user_scene):
    before = files_below(user_scene.parent)
    for arguments in (["check", user_scene], ["run", user_scene, "-o", "result"]):
        assert_refused(sonject(*arguments), 3, "user.yaml:15:11: objects[0].user: ", ALLOW)
    assert files_below(user_scene.parent) == before


def test_a_sphere_by_code_is_the_sphere(sonject, scene, user_scene, tmp_path):
    sonject.done("run", scene, "-o", "sphere")
    answer = sonject.done("run", user_scene, ALLOW, "-o", "user")
    truths = [
        json.loads((tmp_path / folder / "truth.json").read_text())["objects"][0]
        for folder in ("sphere", "user")
    ]
    assert truths[1]["shape"] == "user"
    # the same rays for the rough part, and other cells for glints: noise at -46 dB of the peak
    sphere, user = (numpy.sqrt(images.read_tiff(tmp_path / folder / "energy.tif"))
                    for folder in ("sphere", "user"))
    assert abs(sphere - user).max() < 1e-2 * sphere.max()
    assert (sphere**2).sum() == pytest.approx((user**2).sum(), rel=1e-3)
    again = sonject("run", user_scene, ALLOW, "-o", "user")
    assert "already holds" in again.stderr
    path = tmp_path / "user" / "run.json"
    facts = json.loads(path.read_text())
    path.write_text(json.dumps({**facts, "inputs": {**facts["inputs"], "device": {}}}))
    again = sonject("run", user_scene, ALLOW, "-o", "user")
    assert_refused(again, 2, "differs in device:")  # code may answer differently there
    path.write_text(json.dumps(facts))
    code = user_scene.parent / "ball.cl"
    code.write_text(SPHERE + "// more\n")
    again = sonject("run", user_scene, ALLOW, "-o", "user")
    assert_refused(again, 2, "differs in objects[].user_shape:")


def test_check_tells_what_it_tried(sonject, user_scene):
    answer = sonject.done("check", ALLOW, user_scene)
    assert "ball.cl): 2416 of 4096 rays meet it, 0 of 2409 that leave it" in answer.stdout


def test_compilers_errors_have_the_users_line(sonject, user_scene):
    code = user_scene.parent / "ball.cl"
    code.write_text(SPHERE.replace("sqrt(square)", "root(square)"))
    answer = sonject("check", user_scene, ALLOW)
    assert answer.returncode == 3 and not answer.stdout
    # a driver's compiler may tell how many errors it found besides
    (line,) = [line for line in answer.stderr.splitlines() if line.startswith("sonject: ")]
    assert "ball.cl:7:" in line and "root" in line


def test_code_that_impulses_name_needs_consent(sonject, scene, tmp_path):
    """What a target was when its impulses were traced says nothing about what it is now."""
    target = tmp_path / "ball.yaml"
    target.write_text("sonject_target: 1\nshape: sphere\ndiameter: 0.5 m\n")
    text = scene.read_text()
    scene.write_text(text.replace("shape: sphere\n    diameter: 0.5 m", "target: ball.yaml"))
    sonject.done("trace", scene, "-o", "impulses.sums")
    target.write_text(
        "sonject_target: 1\nshape: user\n"
        "user: {file: ball.cl, bounding_radius: 25 cm, parameters: [0.25]}\n"
    )
    (tmp_path / "ball.cl").write_text(SPHERE)
    before = files_below(tmp_path)
    form = ["form", "impulses.sums", "-o", "result"]
    assert_refused(sonject(*form), 3, "ball.yaml:3:7: user: ", ALLOW)
    assert_refused(sonject(*form, ALLOW), 3, "is not what was traced")
    assert files_below(tmp_path) == before


def test_a_campaign_with_code_names_its_device(sonject, user_scene, tmp_path):
    (tmp_path / "campaign.yaml").write_text(
        "sonject_campaign: 1\nscene: scene.yaml\nimages: 2\nsplits: {all: 1}\n"
        "chip: {rows: 64, columns: 64}\nswaths: [{path: swath.tif}]\n"
        "targets: [{class: ball, object: {shape: user, user: "
        "{file: ball.cl, bounding_radius: 25 cm, parameters: [0.25]}}}]\n"
    )
    command = ["campaign", "campaign.yaml", "-o", "data", "--only=0"]
    assert_refused(sonject(*command), 3, "objects[0].user", ALLOW)
    sonject.done(*command, ALLOW)
    path = tmp_path / "data" / "campaign.json"
    head = json.loads(path.read_text())
    assert head["device"]["name"] in sonject("devices").stdout
    path.write_text(json.dumps({**head, "inputs": {**head["inputs"], "device": {}}}))
    assert_refused(sonject(*command, ALLOW), 2, "data: ", "differs in device:")
