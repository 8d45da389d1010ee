"""A seabed that is not level."""

import struct

import numpy
import pytest

import sonject


def mound(height_m=0.2):
    """Over the patch of make_scene: along-track 0...2.4 m, ground range 22.9...26.5 m."""
    along, out = numpy.meshgrid(numpy.arange(96) * 0.025, 22.9 + numpy.arange(150) * 0.025, indexing="ij")
    distance = numpy.hypot(along - 1.2, out - 24.5) / 0.5
    return numpy.where(distance < 1.0, 0.5 * height_m * (1 + numpy.cos(numpy.pi * distance)), 0.0)


def test_heights_change_the_image_where_they_are(make_scene, amplitude_patch):
    scene = make_scene(objects=[])
    scene.set_relief(mound(), first_ground_range_m=22.9)
    result = sonject.inject(amplitude_patch, scene)
    assert result.visibility.max() > 1.5
    assert result.visibility.min() < 0.5
    untouched = result.influence == 0
    assert untouched.sum() > 2000
    assert numpy.array_equal(result.image[untouched], amplitude_patch[untouched])
    scene.set_relief(None)
    assert numpy.array_equal(sonject.inject(amplitude_patch, scene).image, amplitude_patch)


def test_objects_rest_on_the_heights(make_scene, amplitude_patch):
    scene = make_scene()
    level = sonject.inject(amplitude_patch, scene).objects[0]
    scene.set_relief(numpy.full((97, 150), -0.1), first_ground_range_m=22.9)
    lowered = sonject.inject(amplitude_patch, scene).objects[0]
    assert lowered.height_m == pytest.approx(level.height_m - 0.1, abs=1e-4)
    assert lowered.burial_m == pytest.approx(level.burial_m, abs=1e-4)


def test_refusals(make_scene, amplitude_patch):
    scene = make_scene(objects=[])
    with pytest.raises(ValueError, match="rows and columns"):
        scene.set_relief([1.0, 2.0])
    with pytest.raises(ValueError, match="rows and columns"):
        scene.set_relief(numpy.zeros((4, 4), dtype=complex))
    with pytest.raises(ValueError, match="empty"):
        scene.set_relief(numpy.zeros((0, 4)))
    with pytest.raises(sonject.SonjectError, match="at row 1, column 2 it is nan"):
        heights = numpy.zeros((3, 3))
        heights[1, 2] = numpy.nan
        scene.set_relief(heights)
    with pytest.raises(sonject.SonjectError, match="relief's row_spacing must be"):
        scene.set_relief(numpy.zeros((3, 3)), row_spacing_m=0.0)
    with pytest.raises(sonject.SonjectError, match="2...16384 rows and columns"):
        scene.set_relief(numpy.zeros((1, 3)))
    scene.set_relief(20 * mound(), first_ground_range_m=22.9)
    with pytest.raises(sonject.SonjectError, match="rises by"):
        sonject.inject(amplitude_patch, scene)


def test_heights_from_a_file_give_the_same_image(context, make_scene, amplitude_patch, tmp_path):
    heights = mound().astype(numpy.float32)
    strip = heights.tobytes()
    tags = {256: 150, 257: 96, 258: 32, 259: 1, 262: 1, 273: 8, 277: 1, 278: 96, 279: len(strip), 339: 3}
    directory = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags.items())
    header = struct.pack("<2sHI", b"II", 42, 8 + len(strip))
    count, end = struct.pack("<H", len(tags)), struct.pack("<I", 0)
    (tmp_path / "heights.tif").write_bytes(header + strip + count + directory + end)
    (tmp_path / "scene.yaml").write_text(
        "sonject: 1\n"
        "input: {uniform: {rows: 96, columns: 128}, geometry: {row_spacing: 0.025, "
        "column_spacing: 0.025, first_slant_range: 25}}\n"
        "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
        "seabed: {relief: [{heights: {file: heights.tif, unit: m, row_spacing: 0.025, "
        "column_spacing: 0.025, first_ground_range: 22.9}}]}\n"
    )
    try:
        of_file = sonject.Scene.read(tmp_path / "scene.yaml", context=context)
    except sonject.SonjectError as error:
        if "no image files" not in str(error):
            raise
        pytest.skip("built without OpenImageIO")
    of_array = make_scene(objects=[])
    of_array.set_relief(heights, first_ground_range_m=22.9)
    images = [sonject.inject(amplitude_patch, scene).image for scene in (of_file, of_array)]
    assert numpy.array_equal(*images)
    assert not numpy.array_equal(images[0], amplitude_patch)
