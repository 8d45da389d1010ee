"""Campaigns on synthetic seabeds: one to fit, and one whose draws a fit must find."""

import json

import numpy

import images

SCENE = """\
sonject: 1
input:
  geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 30 m}
sonar: {frequency: 300 kHz, bandwidth: 20 kHz, altitude: 8 m, resolution: 6 cm, response: hamming}
"""

# Lowest and highest draws, m and dB: those that a user starts with, and those that made the contacts.
START = {"length": (1.4, 3.2), "width": (0.8, 1.8), "height": (0.4, 0.9)}
HIDDEN = {"length": (0.9, 2.0), "width": (0.45, 1.0), "height": (0.25, 0.6), "level": (9, 19), "floor": -15}

CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: {images}
seed: {seed}
chip: {{rows: {rows}, columns: {columns}, edge: 4, spread: 0.3}}
empty: 0 # all have a target
{visible}
splits: {{all: 1}}
swaths: [{swaths}]
draw: # of all
  objects[].heading: {{uniform: [0 deg, 360 deg]}}
  objects[].burial.fraction: {{uniform: [0, 0.3]}}
  {floor}
targets:
{targets}"""

TARGET = """\
  - class: {shape}
    object: {{shape: {shape}{more}}}
    draw:
      length: {{log_uniform: [{length[0]} m, {length[1]} m]}} # overall
      width: {{log_uniform: [{width[0]} m, {width[1]} m]}}
      height: {{log_uniform: [{height[0]} m, {height[1]} m]}}
      {level}
"""


def make_seabeds(sonject, rows=300, columns=500, numbers=(1, 2)):
    for number in numbers:
        sonject.done("seabed", "-o", f"seabed_{number}.tif", "--seed", number, "--rows", rows, "--columns", columns,
                     "--ripple-contrast", "0.1", "--row-spacing", "0.05", "--column-spacing", "0.05")


def campaign(draws, images, seed, rows=96, columns=160, shapes=("box", "ellipsoid"), more="",
             swaths=("seabed_1.tif", "seabed_2.tif")):
    """Returns the text of a campaign. more: other keys of all objects."""
    level = draws.get("level")
    floor = draws.get("floor")
    return CAMPAIGN.format(
        images=images, seed=seed, rows=rows, columns=columns,
        swaths=", ".join(f"{{path: {swath}}}" for swath in swaths),
        visible="visible: {highlight: 1.2 dB, shadow: -2.3 dB}" if level else "# whether it is seen or not",
        floor=f"injection.noise_floor: {floor} dB" if floor else "",
        targets="".join(
            TARGET.format(shape=shape, more=more, level=f"level.over_seabed: {{uniform: [{level[0]} dB, {level[1]} dB]}}"
                          if level else "", **{key: draws[key] for key in ("length", "width", "height")})
            for shape in shapes))


def drawn(folder):
    """Returns medians over a data set's images: length, width and proud height in m, level and floor in dB."""
    values = []
    for path in sorted((folder / "all" / "truth").glob("*.json")):
        truth = json.loads(path.read_text())
        thing = truth["objects"][0]
        values.append((thing["length_m"], thing["width_m"], thing["body_height_m"] - thing["burial_m"],
                       thing["level"]["over_seabed_db"], truth["blending"]["noise_floor_db"]))
    return numpy.median(numpy.array(values, float), axis=0)


WINDOW = (48, 80)  # rows and columns of a detector's window
CELL = 4


def _features(image, row, column):
    rows, columns = WINDOW
    window = image[row:row + rows, column:column + columns]
    cells = window.reshape(rows // CELL, CELL, columns // CELL, CELL).mean(axis=(1, 3))
    return 10 * numpy.log10(numpy.maximum(cells, 1e-6) / numpy.median(window)).ravel()


def target_windows(folder, random):
    """Returns features of windows around the labels of a data set, moved by up to 3 pixels."""
    windows = []
    labels = json.loads((folder / "all" / "coco.json").read_text())
    names = {image["id"]: image["file_name"] for image in labels["images"]}
    for label in labels["annotations"]:
        image = abs(images.read_tiff(folder / "all" / names[label["image_id"]]))
        column, row, _, height = label["bbox"]
        corner = numpy.array([row + height / 2 - WINDOW[0] / 2, column - 12]).astype(int) + random.integers(-3, 4, 2)
        windows.append(_features(image, *numpy.clip(corner, 0, numpy.subtract(image.shape, WINDOW))))
    return numpy.array(windows)


def seabed_windows(paths, count, random):
    swaths = [abs(images.read_tiff(path)) for path in paths]
    return numpy.array([_features(swath, *random.integers(0, numpy.subtract(swath.shape, WINDOW)))
                        for swath in (swaths[i % len(swaths)] for i in range(count))])
