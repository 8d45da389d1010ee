"""Values on their way into the C structures."""

import math

import numpy
import pytest

import sonject
from sonject import _interface as s
from sonject._values import initialised


def test_defaults_are_the_librarys():
    defaults = initialised(s.sonject_sonar_params)
    sonar = sonject.Sonar()
    assert sonar.centre_frequency_hz == defaults.centre_frequency_hz == 100e3
    assert sonar.altitude_m == defaults.altitude_m == 10.0
    assert sonar.response_window is sonject.ResponseWindow.RECTANGULAR


def test_an_object_without_a_pose_is_the_librarys_default():
    ours = bytes(sonject.Sphere(diameter_m=0.5).to_structure())
    assert ours == bytes(initialised(s.sonject_object_params))


def test_values_arrive_in_their_fields():
    thing = sonject.Capsule(
        length_m=2.3,
        diameter_m=0.3,
        position=sonject.Metres(along_track_m=1.5, slant_range_m=52.0),
        heading_rad=sonject.from_degrees(30),
        burial_m=0.1,
        material=sonject.Material(reflection=-0.5),
        name="Röhre",
        class_name="pipe",
    ).to_structure()
    assert (thing.shape, thing.length_m, thing.diameter_m) == (3, 2.3, 0.3)
    assert (thing.position_kind, thing.position_along, thing.position_range) == (1, 1.5, 52.0)
    assert thing.heading_rad == math.pi / 6
    assert thing.burial_m == 0.1
    assert thing.material.reflection == -0.5
    assert thing.name.decode() == "Röhre"
    assert thing.class_name == b"pipe"


def test_sizes_arrive_in_their_fields():
    def numbers(thing, *names):
        structure = thing.to_structure()
        return structure.shape, *(getattr(structure, name) for name in names)

    box = {"length_m": 1.5, "width_m": 0.5, "height_m": 0.25}
    assert numbers(sonject.Disc(diameter_m=2), "diameter_m") == (4, 2.0)
    assert numbers(sonject.Ellipsoid(**box), *box) == (5, 1.5, 0.5, 0.25)
    assert numbers(sonject.Cuboid(**box), *box) == (6, 1.5, 0.5, 0.25)
    wedge = sonject.Wedge(front_height_m=0.1, **box)
    assert numbers(wedge, *box, "front_height_m") == (7, 1.5, 0.5, 0.25, 0.1)
    cone = sonject.Cone(diameter_m=1, height_m=0.5)
    assert numbers(cone, "diameter_m", "height_m") == (8, 1.0, 0.5)
    stump = sonject.TruncatedCone(diameter_m=1, top_diameter_m=0.5, height_m=0.4)
    assert numbers(stump, "diameter_m", "top_diameter_m", "height_m") == (9, 1.0, 0.5, 0.4)
    ring = sonject.Torus(diameter_m=0.7, height_m=0.2)
    assert numbers(ring, "diameter_m", "height_m") == (10, 0.7, 0.2)
    tank = sonject.Cylinder(
        length_m=2,
        diameter_m=1,
        nose_end="spherical",
        nose_end_depth_m=0.2,
        tail_end=sonject.End.OPEN,
    )
    ends = ("nose_end", "nose_end_depth_m", "tail_end", "tail_end_depth_m")
    assert numbers(tank, *ends) == (2, 2, 0.2, 1, 0.0)


def test_cuts_and_burial():
    cut = sonject.Cut(azimuth_rad=0.5, elevation_rad=-0.25, distance_m=0.1)
    thing = sonject.Sphere(diameter_m=1, cuts=[cut], burial_fraction=0.3).to_structure()
    assert (thing.cut_count, thing.burial_kind, thing.burial_fraction) == (1, 1, 0.3)
    given = thing.cuts[0]
    assert (given.azimuth_rad, given.elevation_rad, given.distance_m) == (0.5, -0.25, 0.1)
    proud = sonject.Sphere(diameter_m=1, proud_height_m=0.75).to_structure()
    assert (proud.burial_kind, proud.proud_height_m, proud.burial_m) == (2, 0.75, 0.0)
    for bad in (
        {"cuts": [cut, cut, cut]},
        {"burial_fraction": 0.5, "proud_height_m": 0.1},
        {"burial_m": 0.5, "proud_height_m": 0.1},
    ):
        with pytest.raises(ValueError, match="cuts|exclude"):
            sonject.Sphere(diameter_m=1, **bad).to_structure()
    with pytest.raises(TypeError, match="cuts must be Cuts"):
        sonject.Sphere(diameter_m=1, cuts=[(0, 0, 1)]).to_structure()


def test_parts_and_their_places():
    shape = sonject.Sphere(diameter_m=0.4, material=sonject.Material.named("rock"))
    part = sonject.Part(
        shape, along_m=1, across_m=2, up_m=3, heading_rad=0.1, pitch_rad=0.2, roll_rad=0.3
    )
    taken, place = part.to_structures()
    assert (taken.diameter_m, taken.material.density_ratio) == (0.4, 2.5)
    assert (place.along_m, place.across_m, place.up_m) == (1.0, 2.0, 3.0)
    assert (place.heading_rad, place.pitch_rad, place.roll_rad) == (0.1, 0.2, 0.3)
    whole = sonject.Parts([part], heading_rad=0.5, name="pair").to_structure()
    assert (whole.shape, whole.heading_rad, whole.name) == (sonject.objects.Shape.PARTS, 0.5, b"pair")


def test_wrong_parts_are_refused(make_scene):
    ball = sonject.Part(sonject.Sphere(diameter_m=1))
    with pytest.raises(ValueError, match="at least one"):
        sonject.Parts([]).to_structure()
    with pytest.raises(TypeError, match="must be a Part"):
        sonject.Parts([sonject.Sphere(diameter_m=1)]).to_structure()
    with pytest.raises(TypeError, match="one shape"):
        sonject.Part(sonject.Parts([ball])).to_structures()
    with pytest.raises(TypeError, match="one shape"):
        sonject.Part("sphere").to_structures()
    cut = sonject.Parts([ball], cuts=[sonject.Cut(distance_m=0.0)])
    small = sonject.Parts([sonject.Part(sonject.Sphere(diameter_m=-1))])
    for wrong in (cut, small):
        with pytest.raises(sonject.SonjectError) as caught:
            make_scene(objects=[wrong])
        assert caught.value.status is sonject.Status.ERROR_INPUT


def test_parts_are_one_object(make_scene, complex_patch):
    """What two parts hold alike counts once: the picture of twins in one place is that of one."""
    ball = sonject.Part(sonject.Sphere(diameter_m=0.5))
    results = [
        sonject.inject(complex_patch, make_scene(objects=[sonject.Parts(parts)]))
        for parts in ([ball], [ball, ball], [ball, sonject.Part(ball.shape, along_m=0.4)])
    ]
    one, twins, pair = (result.objects for result in results)
    assert len(one) == len(twins) == len(pair) == 1
    assert pair[0].highlight.rows > one[0].highlight.rows + 10  # 16 rows of 2.5 cm more
    assert twins[0].target_strength_db == one[0].target_strength_db
    assert results[1].image.tobytes() == results[0].image.tobytes()


def test_every_shape_is_injected(make_scene, complex_patch):
    shapes = [
        sonject.Disc(diameter_m=0.5, pitch_rad=-0.8),
        sonject.Ellipsoid(length_m=0.5, width_m=0.4, height_m=0.3),
        sonject.Cuboid(length_m=0.5, width_m=0.4, height_m=0.3),
        sonject.Wedge(length_m=0.5, width_m=0.4, height_m=0.3),
        sonject.Cone(diameter_m=0.5, height_m=0.3),
        sonject.TruncatedCone(diameter_m=0.5, top_diameter_m=0.3, height_m=0.3),
        sonject.Torus(diameter_m=0.5, height_m=0.1),
        sonject.Cylinder(length_m=0.5, diameter_m=0.2, nose_end="open", tail_end="spherical"),
        sonject.Sphere(diameter_m=0.5, cuts=[sonject.Cut(elevation_rad=1.5, distance_m=0.0)]),
    ]
    for shape in shapes:
        result = sonject.inject(complex_patch, make_scene(objects=[shape]))
        assert result.objects[0].highlight_pixels > 0, shape


TETRAHEDRON = """
v 0 0 0
v 600 0 0
v 0 600 0
v 0 0 400
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""


def test_meshes_are_read_and_injected(make_scene, complex_patch, tmp_path):
    path = tmp_path / "tetrahedron.obj"
    path.write_text(TETRAHEDRON)
    scene = make_scene(objects=[])
    number = scene.add_mesh(path, unit_m=1e-3, axes=(2, -1, 3))
    scene.add(sonject.Mesh(mesh=number))
    result = sonject.inject(complex_patch, scene)
    assert result.objects[0].highlight_pixels > 0
    assert abs(result.objects[0].height_m - 0.2) < 1e-6  # it rests on the seabed
    path.write_text(TETRAHEDRON.replace("f 1 4 3\n", ""))
    with pytest.raises(sonject.SonjectError, match="tetrahedron.obj"):
        scene.add_mesh(path)
    assert scene.add_mesh(path, allows_open=True) == 1
    with pytest.raises(sonject.SonjectError, match="there is no mesh 2"):
        scene.add(sonject.Mesh(mesh=2))


def test_meshes_are_cut(make_scene, complex_patch, tmp_path):
    path = tmp_path / "tetrahedron.obj"
    path.write_text(TETRAHEDRON)
    scene = make_scene(objects=[])
    number = scene.add_mesh(path, unit_m=1e-3)
    top_off = sonject.Cut(elevation_rad=math.pi / 2, distance_m=0.0)
    scene.add(sonject.Mesh(mesh=number, cuts=[top_off], burial_fraction=0.5))
    result = sonject.inject(complex_patch, scene)
    assert result.objects[0].highlight_pixels > 0
    # the centre, that of the whole, lies over the lowest point by 0.2 m, which is all that is left
    assert abs(result.objects[0].height_m - 0.1) < 1e-6
    with pytest.raises(sonject.SonjectError, match="cuts leave nothing of the object"):
        scene.add(sonject.Mesh(mesh=number, cuts=[sonject.Cut(distance_m=-0.4)]))
    code = scene.add_user_shape(SPHERE, bounding_radius_m=0.25, parameters=[0.25])
    scene.add(sonject.UserShape(user_shape=code, cuts=[top_off]))
    with pytest.raises(sonject.SonjectError, match="cuts leave nothing of the object"):
        scene.add(sonject.UserShape(user_shape=code, cuts=[sonject.Cut(distance_m=-0.26)]))


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


def test_user_shapes_are_taken_and_injected(make_scene, complex_patch):
    scene = make_scene(objects=[])
    number = scene.add_user_shape(SPHERE, bounding_radius_m=0.25, parameters=[0.25])
    scene.add(sonject.UserShape(user_shape=number))
    ours = sonject.inject(complex_patch, scene)
    theirs = sonject.inject(complex_patch, make_scene())
    # the same rays meet the same sphere, but for roundings along its outline
    difference = ours.objects[0].target_strength_db - theirs.objects[0].target_strength_db
    assert abs(difference) < 0.01
    assert ours.objects[0].highlight_pixels == theirs.objects[0].highlight_pixels
    with pytest.raises(sonject.SonjectError, match="there is no user shape 1"):
        scene.add(sonject.UserShape(user_shape=1))
    with pytest.raises(sonject.SonjectError, match="bounding_radius must be"):
        scene.add_user_shape(SPHERE, bounding_radius_m=0.0)
    with pytest.raises(sonject.SonjectError, match="ball.cl:95: #include is not possible"):
        scene.add_user_shape(
            "\n#include <x.h>\n" + SPHERE, bounding_radius_m=1, name="ball.cl", first_line=94
        )
    with pytest.raises(ValueError, match="at most 16, not 17"):
        scene.add_user_shape(SPHERE, bounding_radius_m=1, parameters=range(17))
    with pytest.raises(ValueError, match="code contains a NUL"):
        scene.add_user_shape("\0", bounding_radius_m=1)
    with pytest.raises(TypeError, match="name must be a text"):
        scene.add_user_shape(SPHERE, bounding_radius_m=1, name=b"ball.cl")


def test_scene_files_with_code_need_consent(tmp_path, context):
    (tmp_path / "ball.cl").write_text(SPHERE)
    path = tmp_path / "scene.yaml"
    path.write_text(
        "sonject: 1\n"
        "input: {uniform: {rows: 96, columns: 128}, geometry: {row_spacing: 2.5 cm,"
        " column_spacing: 2.5 cm, first_slant_range: 25}}\n"
        "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
        "objects: [{shape: user, user: {file: ball.cl, bounding_radius: 0.25, parameters: [0.25]}}]\n"
    )
    with pytest.raises(sonject.SonjectError, match="code that would run with your rights"):
        sonject.Scene.read(path, context=context)
    scene = sonject.Scene.read(path, context=context, allows_user_shapes=True)
    assert "user shape 1 (" in sonject.check(scene)


def test_smooth_facets_scatter_otherwise(make_scene, complex_patch, tmp_path):
    path = tmp_path / "tetrahedron.obj"
    path.write_text(TETRAHEDRON)
    rough = sonject.Material(reflection=0, lambert=0.1)
    energies = []
    for angle in (0.0, 3.1):
        scene = make_scene(objects=[])
        number = scene.add_mesh(path, unit_m=1e-3, smooth_angle_rad=angle)
        scene.add(sonject.Mesh(mesh=number, material=rough))
        energies.append(sonject.inject(complex_patch, scene).energy)
    assert numpy.isfinite(energies).all()
    assert (energies[0] != energies[1]).any()
    for wrong in (-0.1, 4.0, math.nan):
        with pytest.raises(sonject.SonjectError, match="smooth normals"):
            scene.add_mesh(path, smooth_angle_rad=wrong)


def test_pixel_positions_are_row_then_column():
    thing = sonject.Sphere(diameter_m=1, position=sonject.Pixels(row=3, column=4)).to_structure()
    assert (thing.position_kind, thing.position_along, thing.position_range) == (2, 3.0, 4.0)


def test_named_materials():
    names = sonject.Material.names()
    assert {"steel", "concrete", "rubber", "wood", "rock", "gravel", "coarse sand"} <= set(names)
    assert {"medium sand", "fine sand", "silt", "clay"} <= set(names)
    for name in names:
        named = sonject.Material.named(name)
        assert named.to_structure().reflection_kind == named.reflection_kind, name
        assert sonject.Material.named(name.replace(" ", "_")) == named
    steel = sonject.Material.named("steel", roughness_m=0.004)
    assert steel.roughness_m == 0.004
    assert steel.lambert == sonject.Material.named("steel").lambert
    with pytest.raises(ValueError, match="'stele' is not one of .*steel"):
        sonject.Material.named("stele")


def test_the_seabeds_forward_material():
    seabed = sonject.Seabed()
    assert (seabed.forward.reflection, seabed.forward.roughness_m) == (0.0, 0.0)
    assert math.isnan(seabed.forward.lambert)
    assert seabed.forward_rule is sonject.ForwardRule.MODEL
    sand = sonject.Material(
        reflection_kind="fluid", density_ratio=1.8, speed_ratio=1.1, loss=0.01, lambert=math.nan
    )
    structure = sonject.Seabed(forward=sand, forward_rule="map").to_structure()
    assert (structure.forward_rule, structure.forward.reflection_kind) == (1, 1)
    assert (structure.forward.density_ratio, structure.forward.speed_ratio) == (1.8, 1.1)
    assert structure.forward.loss == 0.01
    assert math.isnan(structure.forward.lambert)


def test_interactions():
    given = sonject.Injection(interactions=3, order_energies=True, estimator="brute_force")
    structure = given.to_structure()
    assert (structure.interactions, structure.order_energies, structure.estimator) == (3, 1, 1)
    default = sonject.Injection()
    assert (default.interactions, default.order_energies) == (1, False)
    assert default.estimator is sonject.Estimator.CONNECT


def test_noise_floor_is_estimated_unless_given():
    assert sonject.Injection().to_structure().estimate_noise == 1
    given = sonject.Injection(noise_floor_db=-20.0).to_structure()
    assert (given.estimate_noise, given.noise_floor_db) == (0, -20.0)


def test_choices_are_taken_by_name_and_value():
    assert sonject.Injection(mode="resynthesise").mode is sonject.Mode.RESYNTHESISE
    assert sonject.Geometry(first_slant_range_m=1, side=1).side is sonject.Side.STARBOARD
    with pytest.raises(ValueError, match="mode must be one of composite, resynthesise"):
        sonject.Injection(mode="replace")


def test_numpy_scalars_are_numbers():
    sonar = sonject.Sonar(altitude_m=numpy.float32(12.5), taylor_terms=numpy.int64(5))
    structure = sonar.to_structure()
    assert (structure.altitude_m, structure.taylor_terms) == (12.5, 5)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: sonject.Injection(seed=-1), "seed must lie within"),
        (lambda: sonject.Injection(seed=2**64), "seed must lie within"),
        (lambda: sonject.Sonar(taylor_terms=2**32), "taylor_terms must lie within"),
        (lambda: sonject.Patch(first_row=-1, first_column=0, rows=1, columns=1), "first_row"),
        (lambda: sonject.Sphere(diameter_m=1, name="x" * 64), "at most 63 bytes"),
        (lambda: sonject.Sphere(diameter_m=1, class_name="a\0b"), "contains a NUL"),
    ],
)
def test_what_a_field_would_cut_or_wrap_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make().to_structure()


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: sonject.Sonar(altitude_m="10"), "altitude_m must be a number"),
        (lambda: sonject.Injection(seed=1.0), "seed must be a whole number"),
        (lambda: sonject.Sphere(diameter_m=1, name=b"x"), "name must be a text"),
        (lambda: sonject.Sphere(diameter_m=1, position=(1, 2)), "position must be"),
        (lambda: sonject.Sphere(diameter_m=1, material="steel"), "material must be"),
        (lambda: sonject.Seabed(forward="fine sand"), "forward must be"),
        (lambda: sonject.Material.named(7), "name must be a text"),
    ],
)
def test_wrong_types_are_refused(make, message):
    with pytest.raises(TypeError, match=message):
        make().to_structure()


def test_the_library_refuses_with_status_and_message(make_scene):
    with pytest.raises(sonject.SonjectError) as caught:
        make_scene(objects=[sonject.Sphere(diameter_m=-1.0)])
    assert caught.value.status is sonject.Status.ERROR_INPUT
    assert "diameter" in caught.value.message
    assert "\n" not in caught.value.message
