"""Times of whole runs with warm program caches: Figure 6 of the paper, from process start to files,
beside the time that the process needs to do nothing (list the devices). Also the injection alone, by
the C interface through the Python bindings, for a 512 x 512 patch. Prints one line each."""
import os
import pathlib
import subprocess
import tempfile
import time

import numpy

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
COMMAND = os.environ["SONJECT_COMMAND"]


def best_time(action, repeats=5):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def time_figure6(folder):
    seabed = folder / "seabed.png"
    subprocess.run([COMMAND, "seabed", "-o", seabed, "--rows", "472", "--columns", "512",
                    "--first-range", "43.6125"], check=True)
    number = iter(range(1000))

    def run():
        subprocess.run([COMMAND, "run", SOURCE / "tools" / "scenes" / "figure6.yaml", "--quiet",
                        "--set", f"input.path={seabed}", "-o", folder / str(next(number))],
                       check=True)

    run()
    whole = best_time(run)
    nothing = best_time(lambda: subprocess.run([COMMAND, "devices"], check=True,
                                               stdout=subprocess.DEVNULL))
    print(f"figure 6, process start to files: {whole:.3f} s (a process that does nothing: "
          f"{nothing:.3f} s)")


def time_injection():
    import sonject

    generator = numpy.random.default_rng(1)
    patch = generator.rayleigh(size=(512, 512)).astype(numpy.float32)
    scene = sonject.Scene(
        sonar=sonject.Sonar(centre_frequency_hz=100e3, bandwidth_hz=30e3, altitude_m=10.0),
        geometry=sonject.Geometry(row_spacing_m=0.025, column_spacing_m=0.025,
                                  first_slant_range_m=43.6),
        objects=[sonject.Capsule(length_m=2.3, diameter_m=0.3, heading_rad=0.6, burial_m=0.1)])
    sonject.inject(patch, scene)
    taken = best_time(lambda: sonject.inject(patch, scene))
    print(f"injection of a capsule into 512 x 512 pixels: {taken:.3f} s")


with tempfile.TemporaryDirectory() as name:
    time_figure6(pathlib.Path(name))
    time_injection()
