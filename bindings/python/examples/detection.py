"""A small detector and classifier that learns from injected targets alone, and what it is worth.

    python3 detection.py [--train N] [--test N] [--picture roc.png] [--chips labels.csv]

Mines, rocks and nothing are injected, in memory, into chips cut from made swaths. Matched filters
find the most target-like place of a chip; features there go to a logistic regression, which tells
mines from the rest. It is tried on chips of swaths, seeds and poses that it was not trained on, and
the ROC curves go to a picture (matplotlib) and, as numbers, to the standard output (JSON).

What that proves: that the features carry over from swath to swath and from pose to pose, within what
sonject can make; and, since rocks are injected too, that they tell shapes and not traces of an
injection. It does not prove that real mines are found: training and test share one simulation, the
swaths are made, and no real clutter is among the chips. For that, give --chips real
ones: a table with the columns file (of a NumPy array of amplitudes, of ROWS x COLUMNS pixels of
SPACING, at about the ranges below) and mine (1 or 0), whose curve is then drawn beside.
"""

import argparse
import csv
import json
import pathlib

import numpy

import sonject

SPACING = 0.05  # m, of rows and columns
ROWS, COLUMNS = 96, 128  # of a chip
SWATH_ROWS, SWATH_COLUMNS = 256, 384
FIRST_RANGE, ALTITUDE = 40.0, 8.0  # m
SONAR = {"frequency": "100 kHz", "bandwidth": "30 kHz", "altitude": ALTITUDE}
CHIPS_A_SWATH = 32
# Matched filters: target's lengths along the track and shadows' lengths in slant range, m.
LENGTHS, SHADOWS, HIGHLIGHT = (0.6, 1.6), (0.8, 1.8), 0.4


def geometry_from(first_range):
    return {"row_spacing": SPACING, "column_spacing": SPACING, "first_slant_range": first_range}


def make_swath(random):
    """Amplitudes of a synthetic seabed with ripples, sediments and speckle of its own."""
    seabed = {
        "rows": SWATH_ROWS,
        "columns": SWATH_COLUMNS,
        "seed": random.integers(2**32),
        "speckle_shape": random.uniform(3.0, 30.0),
        "ripple_wavelength": random.uniform(0.3, 1.5),
        "ripple_contrast": random.uniform(0.0, 0.7),
        "ripple_heading": f"{random.uniform(0.0, numpy.pi)} rad",
        "patch_contrast": random.uniform(0.0, 6.0),
    }
    swath = {"synthetic": seabed, "geometry": geometry_from(FIRST_RANGE)}
    with sonject.Scene(input=swath, sonar=SONAR) as scene:
        return sonject.inject(None, scene).image


def make_mine(random, place):
    """A cylinder or a truncated cone, as they lie about."""
    burial, heading = random.uniform(0.0, 0.3), random.uniform(0.0, 2 * numpy.pi)
    placing = {"position": place, "burial": {"fraction": burial}, "heading": f"{heading} rad",
               "class": "mine"}
    if random.random() < 0.5:
        return {"shape": "cylinder", "length": random.uniform(1.4, 2.2),
                "diameter": random.uniform(0.4, 0.6), **placing}
    return {"shape": "truncated_cone", "diameter": random.uniform(0.8, 1.1), "top_diameter": 0.5,
            "height": 0.45, **placing}


def make_rock(random, place):
    """A boulder: two ellipsoids that overlap, of sizes that mines have too."""

    def block(scale):
        sizes = scale * random.uniform(0.5, 1.3, 3)
        return {"shape": "ellipsoid", "length": sizes[0], "width": sizes[1],
                "height": 0.6 * sizes[2]}

    shift = random.uniform(-0.3, 0.3, 2)
    return {
        "parts": [block(1.0),
                  block(0.7) | {"at": {"along": shift[0], "across": shift[1], "up": 0.1}}],
        "material": {"name": "rock", "roughness": "1 cm"},
        "position": place,
        "burial": {"fraction": random.uniform(0.0, 0.4)},
        "heading": f"{random.uniform(0.0, 2 * numpy.pi)} rad",
        "class": "rock",
    }


def make_chip(random, swath, kind):
    """A chip of the swath with a mine, a rock or nothing in it."""
    row = int(random.integers(swath.shape[0] - ROWS))
    column = int(random.integers(swath.shape[1] - COLUMNS))
    patch = swath[row : row + ROWS, column : column + COLUMNS]
    if kind == "nothing":
        return patch
    place = {"row": random.uniform(0.35, 0.65) * ROWS, "column": random.uniform(0.3, 0.5) * COLUMNS}
    maker = make_mine if kind == "mine" else make_rock
    with sonject.Scene(
        sonar=SONAR,
        input={"geometry": geometry_from(FIRST_RANGE + column * SPACING)},
        injection={"seed": random.integers(2**32)},
        seabed={"lambert": 10 ** random.uniform(-3.0, -2.4)},
        objects=[maker(random, place)],
    ) as scene:
        return sonject.inject(patch, scene).image


def chips(seed, count):
    """Yields (chip, kind) without any file; half of them mines. Another seed, other swaths."""
    random = numpy.random.default_rng(seed)
    for number in range(count):
        if number % CHIPS_A_SWATH == 0:
            swath = make_swath(random)
        kind = "mine" if number % 2 == 0 else ("rock", "nothing")[number // 2 % 2]
        yield make_chip(random, swath, kind), kind


def normalised(chip):
    """Levels in dB over the chip's median, smoothed over 3 x 3 pixels against speckle."""
    intensity = numpy.asarray(chip, numpy.float64) ** 2
    padded = numpy.pad(intensity, 1, mode="edge")
    rows, columns = intensity.shape
    smooth = sum(padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3)) / 9
    return 10 * numpy.log10(numpy.maximum(smooth / numpy.median(smooth), 1e-4))


def boxes():
    """Highlight's and shadow's sizes in pixels of each matched filter: (rows, columns, shadow)."""
    pixels = lambda metres: max(1, round(metres / SPACING))
    return [
        (pixels(length), pixels(HIGHLIGHT), pixels(shadow))
        for length in LENGTHS
        for shadow in SHADOWS
    ]


def box_means(levels, rows, columns):
    """Mean over rows x columns pixels from each pixel on, where they fit."""
    sums = numpy.pad(levels, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
    inner = sums[rows:, columns:] - sums[:-rows, columns:] - sums[rows:, :-columns]
    return (inner + sums[:-rows, :-columns]) / (rows * columns)


def features_of(chip):
    """What is seen at the best place of each matched filter, and of the best one its surroundings."""
    levels = normalised(chip)
    values, best = [], None
    for rows, columns, shadow in boxes():
        bright = box_means(levels, rows, columns)[:, : levels.shape[1] - columns - shadow + 1]
        dark = box_means(levels, rows, shadow)[:, columns:][:, : bright.shape[1]]
        score = bright - dark
        row, column = numpy.unravel_index(score.argmax(), score.shape)
        values += [score.max(), bright[row, column], dark[row, column]]
        if best is None or score.max() > best[0]:
            best = score.max(), row, column, rows, columns
    _, row, column, rows, columns = best
    top, left = max(0, row - rows), max(0, column - columns)
    around = levels[top : row + 2 * rows, left : column + 4 * columns]
    bright, dark = around > 6.0, around < -6.0
    extents = [mask.any(axis).sum() for mask in (bright, dark) for axis in (0, 1)]
    return numpy.array([*values, bright.sum(), dark.sum(), *extents, around.max(), around.min()])


class LogisticRegression:
    """Of standardised features, with a ridge; fitted by Newton's method."""

    def __init__(self, features, labels, ridge=1.0):
        self.mean, self.scale = features.mean(0), features.std(0) + 1e-9
        inputs, self.weights = self._inputs(features), numpy.zeros(features.shape[1] + 1)
        for _ in range(25):
            chance = self._chance(inputs)
            slope = inputs.T @ (labels - chance) - ridge * self.weights
            bend = (inputs.T * (chance * (1 - chance))) @ inputs
            self.weights += numpy.linalg.solve(bend + ridge * numpy.eye(len(slope)), slope)

    def _inputs(self, features):
        scaled = (features - self.mean) / self.scale
        return numpy.column_stack([scaled, numpy.ones(len(features))])

    def _chance(self, inputs):
        return 1 / (1 + numpy.exp(-numpy.clip(inputs @ self.weights, -30, 30)))

    def __call__(self, features):
        """Of each row, how likely it is a mine."""
        return self._chance(self._inputs(features))


def roc(scores, labels):
    """(false alarm rates, detection rates) as the threshold falls; equal scores fall together."""
    order = numpy.argsort(-scores, kind="stable")
    last = numpy.append(numpy.flatnonzero(numpy.diff(scores[order])), len(order) - 1)
    hits, alarms = numpy.cumsum(labels[order])[last], numpy.cumsum(1 - labels[order])[last]
    return numpy.append(0, alarms / alarms[-1]), numpy.append(0, hits / hits[-1])


def area(curve, labels):
    """Area under a ROC curve, and its standard error (Hanley and McNeil 1982)."""
    alarms, hits = curve
    a = float(numpy.sum(numpy.diff(alarms) * (hits[1:] + hits[:-1]) / 2))
    mines, others = labels.sum(), (1 - labels).sum()
    spread = (mines - 1) * (a / (2 - a) - a * a) + (others - 1) * (2 * a * a / (1 + a) - a * a)
    return a, float(numpy.sqrt(max(0.0, a * (1 - a) + spread) / (mines * others)))


def describe(pairs):
    """Features and kinds of chips that come one by one."""
    rows = [(features_of(chip), kind) for chip, kind in pairs]
    return numpy.array([row for row, _ in rows]), numpy.array([kind for _, kind in rows])


def read_chips(table):
    """Yields the chips of a table of real ones, as (chip, "mine" or "other")."""
    with open(table, newline="", encoding="utf-8") as file:
        for entry in csv.DictReader(file):
            chip = numpy.abs(numpy.load(pathlib.Path(table).parent / entry["file"]))
            if chip.shape != (ROWS, COLUMNS):
                raise SystemExit(f"{entry['file']}: {chip.shape} pixels, not {ROWS} x {COLUMNS}")
            yield chip, "mine" if entry["mine"] == "1" else "other"


def curves_of(model, features, kinds):
    """{name: (curve, area, error)} of mines against each other kind, and against all."""
    scores, found = model(features), {}
    for kind in ["all others", *sorted(set(kinds) - {"mine"})]:
        chosen = numpy.isin(kinds, ["mine", kind]) if kind != "all others" else kinds != ""
        labels = (kinds[chosen] == "mine").astype(int)
        curve = roc(scores[chosen], labels)
        found[f"mine or {kind}"] = (curve, *area(curve, labels))
    return found


def draw(curves, picture):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5, 5), layout="constrained")
    for name, (curve, a, error) in curves.items():
        axes.plot(*curve, label=f"{name}: {a:.3f} ± {error:.3f}")
    axes.plot([0, 1], [0, 1], color="gray", linewidth=0.5)
    axes.set(xlabel="false alarm rate", ylabel="detection rate", xlim=(0, 1), ylim=(0, 1))
    axes.set_title("trained on injected images alone, tested on unseen swaths", fontsize=9)
    axes.legend(loc="lower right", title="area under the curve")
    figure.savefig(picture, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--train", type=int, default=512, metavar="N", help="chips to learn from")
    parser.add_argument("--test", type=int, default=256, metavar="N", help="chips to try it on")
    parser.add_argument("--picture", type=pathlib.Path, help="PNG with the ROC curves")
    parser.add_argument("--chips", type=pathlib.Path, help="table of real chips: file,mine")
    options = parser.parse_args()
    features, kinds = describe(chips(1, options.train))
    model = LogisticRegression(features, (kinds == "mine").astype(float))
    curves = curves_of(model, *describe(chips(2, options.test)))
    if options.chips:
        real = curves_of(model, *describe(read_chips(options.chips)))
        curves["real chips"] = real["mine or all others"]
    print(json.dumps({name: {"area": a, "error": error} for name, (_, a, error) in curves.items()}))
    if options.picture:
        draw(curves, options.picture)


if __name__ == "__main__":
    main()
