"""Makes docs/demo.png of the demo: before, after, and ground truth, side by side.

    python3 docs/demo.py COMMAND PNG

runs COMMAND, a built sonject. A pixel of the picture is the mean intensity of 2 x 2 of the image's.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy
from PIL import Image

SCENE = pathlib.Path(__file__).resolve().parents[1] / "tools" / "scenes" / "demo.yaml"
GREYS, DARKEST_DB, BRIGHTEST_DB, GAP = 64, -32.0, -8.0, 8
WHITE = GREYS - 1


def halve(pixels):
    """Means of 2 x 2 pixels."""
    rows, columns = pixels.shape
    return pixels.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3))


def grey(path):
    """Grey levels of an image of amplitudes, in dB."""
    level = 10 * numpy.log10(halve(numpy.array(Image.open(path), numpy.float64) ** 2) + 1e-12)
    share = (level - DARKEST_DB) / (BRIGHTEST_DB - DARKEST_DB)
    return numpy.rint(share.clip(0, 1) * WHITE).astype(numpy.uint8)


def main():
    command, picture = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for each, change in (("before", ["--set", "objects=[]"]), ("after", [])):
            subprocess.run([command, "run", SCENE, "-o", folder / each, "--quiet", *change], check=True)
        before, after = (grey(folder / each / "image.tif") for each in ("before", "after"))
        labels = Image.open(folder / "after" / "labels.png")
        colours = labels.getpalette()
        numbers = numpy.array(labels)[::2, ::2]
    truth = numpy.where(numbers > 0, GREYS + numbers - 1, 0).astype(numpy.uint8)
    gap = numpy.full((len(before), GAP), WHITE, numpy.uint8)
    made = Image.fromarray(numpy.hstack([before, gap, after, gap, truth]), "P")
    palette = [round(255 * i / WHITE) for i in range(GREYS) for _ in range(3)]
    made.putpalette(palette + colours[3 : 3 * (256 - GREYS)])
    made.save(picture, optimize=True)


if __name__ == "__main__":
    main()
