"""Makes docs/demo.png: the demo's image before and after, and its ground truth, side by side.

    python3 docs/demo.py COMMAND PNG

COMMAND is a built sonject. A pixel of the picture is the mean intensity of 2 x 2 pixels of the image.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy
from PIL import Image

SCENE = pathlib.Path(__file__).resolve().parents[1] / "tools" / "scenes" / "demo.yaml"
GREYS, GAP = 64, 8
WHITE = GREYS - 1


def grey(amplitudes, darkest_db, brightest_db, step=1):
    """Returns grey levels, linear in dB, of the mean intensity of step x step pixels of amplitude."""
    rows, columns = (size // step for size in amplitudes.shape)
    pixels = amplitudes[: rows * step, : columns * step].astype(numpy.float64) ** 2
    level = 10 * numpy.log10(pixels.reshape(rows, step, columns, step).mean(axis=(1, 3)) + 1e-12)
    share = (level - darkest_db) / (brightest_db - darkest_db)
    return numpy.rint(share.clip(0, 1) * WHITE).astype(numpy.uint8)


def save(picture, panels, colours=()):
    """Writes panels with equal numbers of rows side by side as a PNG. Values from GREYS on number the colours."""
    gap = numpy.full((len(panels[0]), GAP), WHITE, numpy.uint8)
    row = [each for panel in panels for each in (gap, panel)][1:]
    made = Image.fromarray(numpy.hstack(row), "P")
    palette = [round(255 * i / WHITE) for i in range(GREYS) for _ in range(3)]
    made.putpalette([*palette, *colours][: 3 * 256])
    made.save(picture, optimize=True)


def main():
    command, picture = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for each, change in (("before", ["--set", "objects=[]"]), ("after", [])):
            subprocess.run([command, "run", SCENE, "-o", folder / each, "--quiet", *change], check=True)
        before, after = (grey(numpy.array(Image.open(folder / each / "image.tif")), -32, -8, step=2)
                         for each in ("before", "after"))
        labels = Image.open(folder / "after" / "labels.png")
        colours = labels.getpalette()[3:]
        numbers = numpy.array(labels)[::2, ::2]
    truth = numpy.where(numbers > 0, GREYS + numbers - 1, 0).astype(numpy.uint8)
    save(picture, [before, after, truth], colours)


if __name__ == "__main__":
    main()
