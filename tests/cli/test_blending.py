"""Targets in measured images: is what was put in like what is there?

Ranges of measured images: amplitude contrast of seabed 0.46 to 0.60 (sub-Rayleigh sidescan less),
shadows 15 to 30 dB below the seabed around them, highlights of objects peak 12 to 20 dB above it.
"""

import json

import numpy
import pytest

import images
from images import tiff_bytes
from measured_images import measured, read_png, read_xtf

OBJECTS = (
    "shape: cylinder, length: 1.5 m, diameter: 0.45 m, heading: 20 deg, burial: 5 cm",
    "shape: truncated_cone, diameter: 1 m, top_diameter: 0.5 m, height: 0.45 m, burial: 3 cm",
    "shape: sphere, diameter: 0.6 m, burial: 8 cm",
)

# The pictures' frequency is not published. At 300 kHz, as sonars of their kind have, 2.5 cm pixels
# take aspects of 5.7 degrees; at 100 kHz they would take 17, and the small sphere's shadow would fill.
SONAR = "{frequency: 300 kHz, bandwidth: 30 kHz, altitude: 10 m}"

# Plain parts of three pictures: patch (row, column, rows, columns) and the objects' pixels.
TILES = {
    "image_02.png": ((150, 200, 310, 300), ((210, 270), (310, 280), (400, 270))),
    "image_11.png": ((130, 150, 340, 330), ((180, 230), (290, 230), (400, 240))),
    "sassed44_1001x1001_original.png": ((640, 110, 330, 380), ((700, 190), (800, 200), (900, 190))),
}

SCENE = """\
sonject: 1
input:
  path: {path}
  geometry: {{row_spacing: {row_spacing}, column_spacing: {column_spacing}, first_slant_range: {first_range}}}
{transfer}
patch: {{row: {patch[0]}, column: {patch[1]}, rows: {patch[2]}, columns: {patch[3]}}}
sonar: {sonar}
seabed: {{lambert: -22 dB}}
objects:
{objects}"""


def scene_text(positions, **parts):
    objects = "".join(
        f"  - {{{shape}, material: steel, level: {{over_seabed: 14 dB}}, "
        f"position: {{row: {row}, column: {column}}}}}\n"
        for shape, (row, column) in zip(OBJECTS, positions)
    )
    return SCENE.format(objects=objects, **parts)


def decibels(ratio):
    return 10 * numpy.log10(ratio)


def inner(mask, pixels):
    """The mask without so many pixels at its edges."""
    for _ in range(pixels):
        smaller = mask.copy()
        smaller[1:] &= mask[:-1]
        smaller[:-1] &= mask[1:]
        smaller[:, 1:] &= mask[:, :-1]
        smaller[:, :-1] &= mask[:, 1:]
        mask = smaller
    return mask


def contrast(values):
    return values.std() / values.mean()


def judge(before, after, folder, patch):
    """Numbers of each object, against the seabed's own energy where it stands."""
    labels = read_png(folder / "labels.png")
    shadow = read_png(folder / "shadow.png") > 0
    highlight = read_png(folder / "highlight.png") > 0
    numbers = []
    for label in range(1, len(OBJECTS) + 1):
        rows, columns = numpy.nonzero(labels == label)
        box = numpy.zeros_like(shadow)
        box[max(patch[0], rows.min() - 20) : rows.max() + 20,
            max(patch[1], columns.min() - 20) : columns.max() + 20] = True
        seabed = (before[box & (labels == 0)] ** 2).mean()
        core = inner(shadow & (labels == label), 2)
        bright = highlight & (labels == label)
        numbers.append({
            "shadow_db": decibels((after[core] ** 2).mean() / seabed),
            "shadow_contrast": contrast(after[core]),
            "peak_db": decibels((after[bright] ** 2).max() / seabed) if bright.any() else None,
        })
    return numbers


def measure(sonject, folder, before, transfer):
    answer = sonject.done("measure", "--seam", folder / f"image{before.suffix}", "--before", before,
                          "--influence", folder / "influence.png", "--targets", folder / "labels.png",
                          "--transfer", transfer)
    return json.loads(answer.stdout)


def check_objects(numbers, shallowest=-14.5):
    """Half a dB beyond the shadows' range: a sphere's is so narrow that the response fills it."""
    for number in numbers:
        assert -30 <= number["shadow_db"] <= shallowest, number
        assert 12 <= number["peak_db"] <= 20, number


def check_seam(seam):
    """Not told from the seabed better than the seabed tells itself, by two standard errors."""
    assert seam["auc"] <= max(0.55, seam["auc_before"]) + 2 * seam["standard_error"], seam


@pytest.mark.parametrize("name", sorted(TILES))
def test_sonar_pictures(sonject, tmp_path, name):
    path = measured(f"sassed/{name}")
    patch, positions = TILES[name]
    (tmp_path / "scene.yaml").write_text(scene_text(
        positions, path=path, patch=patch, row_spacing="2.5 cm", column_spacing="2.5 cm",
        first_range="43.6125 m", transfer="  transfer: {kind: schlick, parameter: 3}",
        sonar=SONAR))
    sonject.done("run", "scene.yaml", "-o", "out", "--quiet")
    out = tmp_path / "out"
    linear = numpy.arange(256) / 255
    linear = linear / (3 - 2 * linear)
    before, after = (linear[read_png(file)] for file in (path, out / "image.png"))
    numbers = judge(before, after, out, patch)
    told = measure(sonject, out, path, "schlick:3")
    print(json.dumps({"image": name, "objects": numbers, **told}))
    assert 0.46 <= told["seabed"]["amplitude_contrast"] <= 0.60
    check_objects(numbers)
    check_seam(told["seam"])


def test_sidescan(sonject, tmp_path):
    samples, altitudes = read_xtf(measured("sidescan/scotsman-iver2.xtf"))
    picture = samples.astype(numpy.uint16)
    (tmp_path / "port.tif").write_bytes(tiff_bytes(picture))
    patch = (330, 560, 125, 420)
    positions = ((355, 620), (395, 690), (432, 760))
    altitude = float(altitudes[patch[0] : patch[0] + patch[2]].mean())
    # pings 0.12 m apart by their positions, 29.98 m in 1024 samples
    (tmp_path / "scene.yaml").write_text(scene_text(
        positions, path="port.tif", patch=patch, row_spacing="12 cm",
        column_spacing="2.928 cm", first_range="1.5 cm", transfer="",
        sonar=f"{{frequency: 600 kHz, bandwidth: 30 kHz, altitude: {altitude:.2f} m, "
              "response: rectangular}"))  # whose side lobes leave a band to judge
    sonject.done("run", "scene.yaml", "-o", "out", "--quiet")
    out = tmp_path / "out"
    before, after = (
        numpy.frombuffer(file.read_bytes(), "<u2", samples.size, 8).reshape(samples.shape) / 65535
        for file in (tmp_path / "port.tif", out / "image.tif"))
    assert after.max() == before.max() == 32767 / 65535  # cut where the sonar cuts
    numbers = judge(before, after, out, patch)
    told = measure(sonject, out, tmp_path / "port.tif", "amplitude")
    print(json.dumps({"image": "sidescan", "objects": numbers, **told}))
    untouched = sonject("measure", "port.tif")
    assert untouched.returncode == 0, untouched.stderr
    # averaged by the sonar: below Rayleigh's 0.523, and as it was
    assert told["seabed"]["amplitude_contrast"] == pytest.approx(
        json.loads(untouched.stdout)["seabed"]["amplitude_contrast"], abs=0.02)
    check_objects(numbers, shallowest=-14)  # five to eight pings wide
    check_seam(told["seam"])


@pytest.mark.parametrize("looks", [1, 4])
@pytest.mark.parametrize("over", [None, -20])
def test_noise_follows_the_seabed_or_does_not(sonject, tmp_path, over, looks):
    """On sand that is 20 dB brighter than mud shadows are brighter; over one level they are as dark."""
    scales = numpy.repeat([1.0, 0.1], 200)[:, None]
    pixels = numpy.random.default_rng(5).rayleigh(scales / 2**0.5, (400, 300)).astype(numpy.float32)
    (tmp_path / "image.tif").write_bytes(tiff_bytes(pixels))
    (tmp_path / "scene.yaml").write_text(f"""\
sonject: 1
input:
  path: image.tif
  geometry: {{row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 30 m}}
sonar: {{frequency: 300 kHz, bandwidth: 15 kHz, altitude: 6 m}}
injection: {{noise_floor: -15 dB, match: {{looks: {looks}}}{"" if over is None else f", noise_floor_over: {over} dB"}}}
objects:
  - {{name: sand, shape: box, length: 2 m, width: 1 m, height: 1 m, position: {{row: 60, column: 100}}}}
  - {{name: mud, shape: box, length: 2 m, width: 1 m, height: 1 m, position: {{row: 340, column: 100}}}}
""")
    sonject.done("run", "scene.yaml", "-o", "out")
    image = images.read_tiff(tmp_path / "out" / "image.tif")
    shadow = inner(read_png(tmp_path / "out" / "shadow.png") > 0, 4)
    levels = [decibels((image[rows][shadow[rows]] ** 2).mean()) for rows in (slice(0, 200), slice(200, 400))]
    if over is None:
        assert levels[0] - levels[1] > 15  # the seabed's level is a mean over metres, which mixes both
    else:
        assert levels == pytest.approx([-35, -35], abs=0.3)  # speckle's error of over 1000 pixels


def test_shadows_over_relief_are_dark_all_over(sonject, tmp_path):
    """Of a real aperture: what an object hides is formed by the same responses as the seabed."""
    (tmp_path / "scene.yaml").write_text("""\
sonject: 1
input:
  synthetic: {rows: 40, columns: 288, seed: 7, ripple_contrast: 0, patch_contrast: 0 dB}
  geometry: {row_spacing: 12 cm, column_spacing: 3 cm, first_slant_range: 19 m}
sonar: {kind: real, array: {length: 32 cm}, frequency: 600 kHz, bandwidth: 25 kHz, altitude: 5.5 m}
seabed: {relief: [{ripples: {wavelength: 1 m, height: 1 mm}}]}
injection: {noise_floor: -60 dB}
objects: [{name: box, shape: box, length: 2 m, width: 0.5 m, height: 0.5 m, position: {row: 20, column: 100}}]
""")
    sonject.done("run", "scene.yaml", "-o", "out")
    columns = (images.read_tiff(tmp_path / "out" / "image.tif")[16:24] ** 2).mean(axis=0)
    seabed = columns[:60].mean()
    # the shadow ends at column 177; the first columns hold the box's own echo and its pulse
    assert decibels(columns[115:170] / seabed).max() < -50
