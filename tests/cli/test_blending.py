"""Tests that targets injected into measured images look like measured targets.

In measured images the amplitude contrast of seabed is 0.46 to 0.60 (less in sub-Rayleigh sidescan).
Shadows lie 15 to 30 dB below the seabed around them. Highlights of objects peak 12 to 20 dB above it.
"""

import json

import numpy
import pytest
from scipy import ndimage

import images
from images import tiff_bytes
from measured_images import measured, read_png, read_xtf

OBJECTS = (
    "shape: cylinder, length: 1.5 m, diameter: 0.45 m, heading: 20 deg, burial: 5 cm",
    "shape: truncated_cone, diameter: 1 m, top_diameter: 0.5 m, height: 0.45 m, burial: 3 cm",
    "shape: sphere, diameter: 0.6 m, burial: 8 cm",
)

# The frequency of the pictures is not published. Sonars of this kind use 300 kHz, where 2.5 cm pixels
# need aspects over 5.7 degrees. At 100 kHz they would need 17, and the small sphere's shadow would fill.
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
    """Returns the mask without that many pixels at its edges."""
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
    """Returns measures of each object, relative to the energy of the seabed around it before the run."""
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


def measure(sonject, image, transfer="amplitude", *masks):
    return json.loads(sonject.done("measure", image, "--transfer", transfer, *masks).stdout)["seabed"]


def check_objects(numbers, shallowest=-14.5):
    """Allows shadows half a dB above the measured range: the response fills the narrow shadow of a sphere."""
    for number in numbers:
        assert -30 <= number["shadow_db"] <= shallowest, number
        assert 12 <= number["peak_db"] <= 20, number


PATCH, MARGIN = 12, 6  # pixels: the side of a patch, and the margin for comparing its level
PAIRS = 2  # pairs of untouched patches for each patch of the band, on opposite sides
FARTHEST = 10  # largest distance of untouched patches, in patches
STEP = 3  # pixels between the places where patches may begin
FOLDS = 5
INNER = slice(MARGIN, MARGIN + PATCH)
OFFSETS = sorted(((PATCH * down, PATCH * right) for down in range(FARTHEST + 1)
                  for right in range(-FARTHEST, FARTHEST + 1) if (down, right) > (0, 0)),
                 key=lambda offset: max(map(abs, offset)))


def window(plane, row, column):
    """Returns the patch that begins at (row, column), with its margin. The plane is padded by the margin."""
    return plane[row : row + PATCH + 2 * MARGIN, column : column + PATCH + 2 * MARGIN]


def find_groups(influence, labels):
    """Returns groups of (pixels inside, pixels around, places). The first place has a patch of the band that
    changed around the targets. The others have the nearest untouched patches of the same outline. These lie
    in pairs on opposite sides, so even changes across the seabed cancel. Where little changes, dark pixels
    change first. Gaps are closed, or the band would have another level even before the injection."""
    square = numpy.ones((3, 3), bool)
    closed = ndimage.binary_closing(numpy.pad(influence, MARGIN, "edge"), square, 3)[MARGIN:-MARGIN, MARGIN:-MARGIN]
    band = numpy.pad(closed & ~ndimage.binary_dilation(labels, square), MARGIN)
    untouched = numpy.pad(~(closed | labels), MARGIN)
    free = untouched.copy()
    groups = []
    for least in (130, 72, 30):  # whole patches first, then the rest of the band
        sums = numpy.lib.stride_tricks.sliding_window_view(
            band[MARGIN:-MARGIN, MARGIN:-MARGIN], (PATCH, PATCH))[::STEP, ::STEP].sum((2, 3))
        for row, column in (STEP * numpy.argwhere(sums >= least)).tolist():
            inside = numpy.zeros((PATCH + 2 * MARGIN,) * 2, bool)
            inside[INNER, INNER] = window(band, row, column)[INNER, INNER]
            if inside.sum() < least:
                continue
            around = window(untouched, row, column)
            places = [(row, column)]
            for down, right in OFFSETS:
                pair = [(row + down, column + right), (row - down, column - right)]
                if min(map(min, pair)) >= 0 and all(
                        window(free, *place).shape == inside.shape and window(free, *place)[inside].all()
                        and window(untouched, *place)[around].all() for place in pair):
                    places += pair
                    for place in pair:
                        window(free, *place)[inside] = False
                if len(places) == 1 + 2 * PAIRS:
                    break
            if len(places) > 1:
                window(band, row, column)[inside] = False
                groups.append((inside, around, places))
    return sorted(groups, key=lambda group: group[2][0])


def describe(pixels, inside, around):
    """Returns a patch's level over its surroundings, contrast and skewness, and the correlation and mean step
    of neighbours along either axis."""
    mean = pixels[inside].mean()
    values = pixels / mean - 1
    spread = values[inside].std()
    told = [numpy.log(mean / pixels[around].mean()) if around.sum() >= 30 else 0, spread,
            (values[inside] ** 3).mean() / spread**3]
    for turned, within in ((values, inside), (values.T, inside.T)):
        both = within[1:] & within[:-1]
        told += [(turned[1:] * turned[:-1])[both].mean() / spread**2, abs(turned[1:] - turned[:-1])[both].mean()]
    return told


def describe_groups(amplitudes, groups):
    """Yields the features of each group, a row for each patch, less the group's mean. Local differences remain."""
    padded = numpy.pad(amplitudes, MARGIN)
    for inside, around, places in groups:
        told = numpy.array([describe(window(padded, *place), inside, around) for place in places])
        yield told - told.mean(axis=0)


def area_under_curve(features, folds, injected):
    """Returns the area under the ROC curve of Fisher's discriminant, learnt from other parts than it judges."""
    right = []
    for fold in range(FOLDS):
        here = folds == fold
        means = [features[~here & (injected == kind)].mean(axis=0) for kind in (False, True)]
        rest = features[~here] - numpy.where(injected[~here, None], means[1], means[0])
        covariance = rest.T @ rest
        covariance += 0.1 * (numpy.diag(numpy.diag(covariance)) - covariance)
        scores = features @ numpy.linalg.solve(covariance, means[1] - means[0])
        right += list((scores[here & injected, None] > scores[here & ~injected]).mean(axis=1))
    return numpy.mean(right)


def seam(groups, shuffles=100):
    """Returns how well a classifier tells injected background from untouched seabed near it (0.5: by chance,
    1: always), and a standard error: the scatter when a random patch of each group counts as injected."""
    counts = [len(group) for group in groups]
    features = numpy.concatenate(groups)
    folds = numpy.repeat(numpy.arange(len(groups)) * FOLDS // len(groups), counts)
    first = numpy.cumsum([0, *counts[:-1]])
    random = numpy.random.default_rng(1)

    def area(chosen):
        return area_under_curve(features, folds, numpy.isin(numpy.arange(len(features)), first + chosen))

    scatter = [area(random.integers(0, counts)) - 0.5 for _ in range(shuffles)]
    return area(0), numpy.sqrt(numpy.mean(numpy.square(scatter)))


def groups_of_run(folder, *planes):
    groups = find_groups(read_png(folder / "influence.png") > 0, read_png(folder / "labels.png") > 0)
    return [list(describe_groups(amplitudes, groups)) for amplitudes in planes]


def check_seam(before, after):
    """Asserts that the classifier succeeds no more often than before the injection, plus two standard errors."""
    (own, _), (found, error) = seam(before, 1), seam(after)
    print(f"seam {found:.3f} +- {error:.3f}, before {own:.3f}, {len(after)} patches")
    assert found <= max(0.55, own) + 2 * error


def test_sonar_pictures(sonject, tmp_path):
    linear = numpy.arange(256) / 255
    linear = linear / (3 - 2 * linear)
    groups = [], []  # one picture alone has too few patches for a sharp verdict
    for name, (patch, positions) in TILES.items():
        path = measured(f"sassed/{name}")
        (tmp_path / "scene.yaml").write_text(scene_text(
            positions, path=path, patch=patch, row_spacing="2.5 cm", column_spacing="2.5 cm",
            first_range="43.6125 m", transfer="  transfer: {kind: schlick, parameter: 3}",
            sonar=SONAR))
        out = tmp_path / name
        sonject.done("run", "scene.yaml", "-o", out, "--quiet")
        before, after = (linear[read_png(file)] for file in (path, out / "image.png"))
        numbers = judge(before, after, out, patch)
        seabed = measure(sonject, out / "image.png", "schlick:3", "--targets", out / "influence.png")
        print(json.dumps({"image": name, "objects": numbers, "seabed": seabed}))
        assert 0.46 <= seabed["amplitude_contrast"] <= 0.60
        check_objects(numbers)
        for all_groups, of_picture in zip(groups, groups_of_run(out, before, after)):
            all_groups += of_picture
    check_seam(*groups)


def test_seams_are_seen(sonject, tmp_path):
    """Plain speckle shows no seam. Flaws of the band are seen: 1 dB, a third more contrast, or a blur of less
    than a pixel."""
    random = numpy.random.default_rng(2)
    before = abs(ndimage.gaussian_filter(random.normal(size=(500, 560)) + 1j * random.normal(size=(500, 560)), 0.6))
    (tmp_path / "bed.tif").write_bytes(tiff_bytes(before.astype(numpy.float32)))
    positions = [(row, column) for row in range(60, 500, 90) for column in (100, 250, 400)]
    (tmp_path / "scene.yaml").write_text(SCENE.format(
        path="bed.tif", patch=(0, 0, 500, 560), row_spacing="2.5 cm", column_spacing="2.5 cm",
        first_range="43.6125 m", transfer="", sonar=SONAR, objects="".join(
            f"  - {{{OBJECTS[2]}, position: {{row: {row}, column: {column}}}}}\n" for row, column in positions)))
    sonject.done("run", "scene.yaml", "-o", "out", "--quiet")
    out = tmp_path / "out"
    after = images.read_tiff(out / "image.tif")
    band = read_png(out / "influence.png") > 0
    flaws = (after * 1.122, after ** 1.33, ndimage.gaussian_filter(after, 0.4))
    check_seam(*groups_of_run(out, before, after))
    for groups in groups_of_run(out, *(numpy.where(band, flaw, after) for flaw in flaws)):
        found, error = seam(groups)
        print(f"flaw {found:.3f} +- {error:.3f}")
        assert found > 0.55 + 2 * error


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
              "response: rectangular}"))  # its side lobes leave a band to judge
    sonject.done("run", "scene.yaml", "-o", "out", "--quiet")
    out = tmp_path / "out"
    before, after = (
        numpy.frombuffer(file.read_bytes(), "<u2", samples.size, 8).reshape(samples.shape) / 65535
        for file in (tmp_path / "port.tif", out / "image.tif"))
    assert after.max() == before.max() == 32767 / 65535  # clipped where the sonar clips
    numbers = judge(before, after, out, patch)
    seabed = measure(sonject, out / "image.tif", "amplitude", "--targets", out / "influence.png")
    print(json.dumps({"image": "sidescan", "objects": numbers, "seabed": seabed}))
    # The sonar averages: the contrast is below Rayleigh's 0.523, and must stay as it was.
    assert seabed["amplitude_contrast"] == pytest.approx(
        measure(sonject, "port.tif")["amplitude_contrast"], abs=0.02)
    check_objects(numbers, shallowest=-14)  # shadows are five to eight pings wide
    check_seam(*groups_of_run(out, before, after))


@pytest.mark.parametrize("looks", [1, 4])
@pytest.mark.parametrize("over", [None, -20])
def test_noise_follows_the_seabed_or_does_not(sonject, tmp_path, over, looks):
    """Shadows are brighter on sand, which is 20 dB above mud. With noise over one level they are equally dark."""
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
        assert levels[0] - levels[1] > 15  # below 20, since the seabed's level is a mean over metres of both
    else:
        assert levels == pytest.approx([-35, -35], abs=0.3)  # the error of speckle over 1000 pixels or more


def test_shadows_over_relief_are_dark_all_over(sonject, tmp_path):
    """The aperture is real. The seabed that an object hides is formed by the same responses as all seabed."""
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


@pytest.mark.parametrize("echo", ["a pixel", "a target", "a blank side", "a blank side and a pixel", "a hole"])
def test_echoes_in_the_image_move_no_levels(sonject, tmp_path, echo):
    """A target's levels hold beside one that the image shows already, beside a single pixel at 66 dB, and beside
    columns or rectangles in which nothing was heard."""
    plain = 0.05 * numpy.random.default_rng(1).rayleigh(numpy.sqrt(0.5), (400, 500)).astype(numpy.float32)
    beside = plain.copy()
    if "blank" in echo:
        beside[:, :235] = 0
    if echo == "a hole":
        beside[50:185, 50:440] = 0
    if "pixel" in echo:
        beside[260, 250] = 100
    if echo == "a target":
        beside[230:240, 240:260] *= 10
    scene = SCENE.format(path="image.npy", row_spacing=0.1, column_spacing=0.05, first_range=40,
                         transfer="  transfer: {kind: amplitude}", patch=(0, 0, 400, 500), sonar=SONAR,
                         objects="  - {shape: cylinder, length: 2 m, diameter: 0.5 m, position: {row: 200, column: 250},\n"
                                 "     level: {over_seabed: 12 dB}}\n")
    levels = []
    for number, image in enumerate((plain, beside)):
        numpy.save(tmp_path / "image.npy", image)
        (tmp_path / "scene.yaml").write_text(scene)
        sonject.done("run", "scene.yaml", "-o", str(number), "--set", "injection.noise_floor=-20 dB")
        intensity = numpy.load(tmp_path / str(number) / "image.npy") ** 2
        levels.append([decibels(intensity[read_png(tmp_path / str(number) / f"{part}.png") > 0].mean())
                       for part in ("highlight", "shadow")])
    assert numpy.abs(numpy.subtract(*levels)).max() < 0.2, levels


MOVED = """\
sonject: 1
input:
  uniform: {rows: 160, columns: 192}
  geometry: {row_spacing: 10 cm, column_spacing: 5 cm, first_slant_range: 60 m}
sonar: {altitude: 10 m, bandwidth: 10 kHz, SONAR}
injection: {noise_floor: -20 dB}
objects:
  - {shape: sphere, diameter: 0.5 m, material: {reflection: 0, lambert: 0.1}, level: {over_seabed: 14 dB}}
"""


# A turned array looks 1.13 m ahead at 65 m. Pings 0.4 m apart have lobes every 1.24 m, and this yaw looks at the first.
@pytest.mark.parametrize("sonar, moved_m", [
    ("kind: real, array: {length: 0.5 m}, frequency: 100 kHz", 0),
    ("kind: real, array: {length: 2 m, heading: 1 deg}, frequency: 200 kHz", 1.13),
    ("resolution: 15 cm, frequency: 100 kHz, motion: {yaw: {advance: 0.4 m, bias: 1.08 deg}}", 1.24),
    ("resolution: 15 cm, frequency: 100 kHz, motion: {sway: [{amplitude: 0.3 m, wavelength: 94.2 m}]}", None),
    ("resolution: 15 cm, frequency: 100 kHz, measured_response: response.csv", 1.0)])
@pytest.mark.parametrize("side", ["port", "starboard"])
def test_objects_are_labelled_where_the_response_puts_their_echoes(sonject, tmp_path, sonar, moved_m, side):
    """The level counts there, and all pixels in which the echo outshines the seabed are the highlight."""
    along = numpy.arange(-40, 41) / 20
    (tmp_path / "response.csv").write_text("along_track_m,real\n" + "".join(
        f"{x:g},{numpy.exp(-((x - 1) / 0.2)**2):.6f}\n" for x in along))
    (tmp_path / "scene.yaml").write_text(MOVED.replace("SONAR", sonar))
    sonject.done("run", "scene.yaml", "-o", "out", "--quiet", "--set", f"input.geometry.side={side}")
    thing = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"][0]
    energy = images.read_tiff(tmp_path / "out" / "energy.tif").astype(float)
    over_seabed = energy / numpy.median(energy)
    peak = numpy.unravel_index(energy.argmax(), energy.shape)
    print(thing["row"], peak, decibels(over_seabed.max()), thing["highlight"])
    # the peak lies between pixels, and the seabed adds 0.2 dB
    assert decibels(over_seabed.max()) == pytest.approx(14, abs=0.7)
    if moved_m is not None:
        assert (peak[0] - thing["row"]) * 0.1 == pytest.approx(moved_m, abs=0.15)
    highlight = read_png(tmp_path / "out" / "highlight.png") > 0
    assert highlight[peak]
    # the echo outshines the seabed that is left: between 1, shadow, and 2, none
    assert not highlight[over_seabed < 0.9].any() and highlight[over_seabed > 2.2].mean() > 0.9
