"""Prints times with warm program caches, one line each:
- Figures 6 (PoCL) and 7 (native) of the paper, from process start to files, beside a process that only lists the devices
- the injection alone for patches of 512 x 512 and 4096 x 4096, by the C interface through the Python bindings,
  and a copy of the patch
- the targets of tools/targets with two interactions
- a mesh of a million triangles, from its file to an image of 400 x 400
- forming an image again at two thirds of the bandwidth, beside a whole run at that bandwidth: figure 7 with three
  interactions, and the same with so many rays that tracing is nearly all of a run"""
import os
import pathlib
import subprocess
import tempfile
import time

import numpy
import sonject

from ring_mesh import write_ring

SCENES = pathlib.Path(os.environ["SONJECT_SOURCE"]) / "tools" / "scenes"
COMMAND = os.environ["SONJECT_COMMAND"]
SONAR = {"frequency": 100e3, "bandwidth": 30e3, "altitude": 10}


def best_time(action, repeats=5):
    times = []
    for number in range(repeats):
        start = time.perf_counter()
        action(number)
        times.append(time.perf_counter() - start)
    return min(times)


def time_figure(figure, device, folder, swath):
    def run(number):
        subprocess.run([COMMAND, "run", SCENES / f"{figure}.yaml", "--quiet", "--device", device, "--set",
                        f"input.path={swath}", "-o", folder / f"{figure} {number}"], check=True)

    run("first")
    whole = best_time(run)
    nothing = best_time(lambda _: subprocess.run([COMMAND, "devices"], check=True,
                                                 stdout=subprocess.DEVNULL))
    print(f"{figure} on {device}, process start to files: {whole:.3f} s (a process that does nothing: "
          f"{nothing:.3f} s)")


def time_injection(side):
    patch = numpy.random.default_rng(1).rayleigh(size=(side, side)).astype(numpy.float32)
    scene = sonject.Scene(
        sonar=SONAR,
        input={"geometry": {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 43.6}},
        injection={"noise_floor": "-25 dB"},
        objects=[{"shape": "capsule", "length": 2.3, "diameter": 0.3, "heading": "0.6 rad", "burial": 0.1}])
    sonject.inject(patch, scene)
    taken = best_time(lambda _: sonject.inject(patch, scene))
    copied = best_time(lambda _: patch.copy())
    print(f"injection of a capsule into {side} x {side} pixels: {taken:.3f} s (a copy of the patch: {copied:.3f} s)")


def time_targets(folder):
    def run(number):
        subprocess.run([COMMAND, "run", SCENES / "targets.yaml", "--quiet", "--set", "injection.interactions=2",
                        "-o", folder / f"targets {number}"], check=True)

    run("first")
    print(f"twelve targets in 600 x 600 pixels, two interactions, process start to files: {best_time(run, 2):.1f} s")


def time_mesh(folder):
    write_ring(folder / "ring.stl")
    for name, shape in (("a mesh of 1,000,000 triangles, STL file", {"shape": "mesh", "mesh": str(folder / "ring.stl")}),
                        ("a torus", {"shape": "torus", "diameter": 1.8, "height": 0.5})):
        def inject(_, shape=shape):
            sonject.inject(None, sonject.Scene(
                sonar=SONAR, objects=[{**shape, "material": {"reflection": 0, "lambert": 0.1}}],
                input={"uniform": {"rows": 400, "columns": 400},
                       "geometry": {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 45}}))

        inject(0)
        print(f"{name} to an image of 400 x 400: {best_time(inject, 3):.2f} s")


def time_stages(folder, swath, rays):
    chosen = {"input.path": swath, "injection.interactions": 3, "injection.rays": rays}
    narrower = {"sonar.bandwidth": "20 kHz"}
    impulses = folder / f"{rays}.sums"
    sonject.trace(sonject.Scene.read(SCENES / "figure7.yaml", chosen), impulses)
    whole = best_time(lambda number: sonject.run(
        sonject.Scene.read(SCENES / "figure7.yaml", {**chosen, **narrower}),
        folder / f"{rays} run {number}"), 2 if rays > 1 else 5)
    again = best_time(lambda number: sonject.form(impulses, folder / f"{rays} {number}", narrower))
    print(f"figure 7, three interactions, {rays} times the rays: a run {whole:.3f} s, its image formed "
          f"anew {again:.3f} s ({again / whole:.3f}), from {impulses.stat().st_size / 1e6:.1f} MB")


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    swath = folder / "swath.png"
    subprocess.run([COMMAND, "seabed", "-o", swath, "--rows", "472", "--columns", "512",
                    "--first-range", "43.6125"], check=True)
    time_figure("figure6", "pthread", folder, swath)
    time_figure("figure7", "native", folder, swath)
    for side in (512, 4096):
        time_injection(side)
    time_targets(folder)
    time_mesh(folder)
    for rays in (1, 64):
        time_stages(folder, swath, rays)
