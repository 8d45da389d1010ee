"""What one injection into 512 x 512 pixels takes more in Python than in C: a scene made, a capsule
put in, the image copied out, by turns in two processes that wait for each other. Prints medians, by
the clock and, as other work disturbs these less, of processors' time, and their ratios.
SONJECT_BENCHMARK_ROUNDS: how many of each (21); python_overhead.py C_PROGRAM."""
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy
import sonject

ROUNDS = int(os.environ.get("SONJECT_BENCHMARK_ROUNDS", "21"))


def inject_in_python(patch):
    """Seconds, those of processors, and the image."""
    wall, processor = time.perf_counter(), time.process_time()
    with sonject.Scene(
        sonar={"frequency": 100e3, "bandwidth": 30e3, "altitude": 10},
        input={"geometry": {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 43.6}},
        objects=[{"shape": "capsule", "length": 2.3, "diameter": 0.3, "heading": "0.6 rad", "burial": 0.1}],
    ) as scene, sonject.inject(patch, scene) as result:
        image = result.image
    return time.perf_counter() - wall, time.process_time() - processor, image


def inject_in_c(process):
    """Seconds, those of processors, and the image's digest."""
    process.stdin.write("\n")
    process.stdin.flush()
    wall, processor, digest = process.stdout.readline().split()
    return float(wall), float(processor), int(digest, 16)


def digest_of(image):
    total = 0xCBF29CE484222325
    for byte in image.tobytes():
        total = (total ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return total


def main():
    patch = numpy.random.default_rng(1).rayleigh(size=(512, 512)).astype(numpy.float32)
    with tempfile.TemporaryDirectory() as name:
        pixels = pathlib.Path(name) / "pixels"
        pixels.write_bytes(patch.tobytes())
        with subprocess.Popen([sys.argv[1], pixels], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              text=True) as process:
            image = inject_in_python(patch)[-1]
            assert inject_in_c(process)[-1] == digest_of(image), "the images differ"
            times = [(inject_in_python(patch), inject_in_c(process)) for _ in range(ROUNDS)]
            process.stdin.close()
    for kind, name in enumerate(("by the clock", "of processors")):
        python, c = (statistics.median(pair[side][kind] for pair in times) for side in (0, 1))
        print(f"one injection into 512 x 512 pixels: {1e3 * python:.1f} ms {name} from Python, "
              f"{1e3 * c:.1f} ms from C: {100 * (python / c - 1):+.1f} %")


main()
