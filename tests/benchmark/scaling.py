"""Prints how time and memory of a run grow with pixels, objects and triangles, with one and two interactions. The
Markdown table shows `total` and `peak_memory_bytes` of run.json. Programs are compiled before."""
import json
import os
import pathlib
import random
import subprocess
import tempfile

from ring_mesh import write_ring

COMMAND = os.environ["SONJECT_COMMAND"]
RANGE = 40  # slant range of the first column, m


def write_scene(path, side, objects, interactions):
    lines = ["sonject: 1",
             f"input: {{synthetic: {{rows: {side}, columns: {side}}}, geometry: {{row_spacing: 2.5 cm, "
             f"column_spacing: 2.5 cm, first_slant_range: {RANGE} m}}}}",
             "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}",
             f"injection: {{interactions: {interactions}}}", "objects:"]
    path.write_text("\n".join(lines + [f"  - {{{text}}}" for text in objects]) + "\n")


def capsules(side, count):
    place = random.Random(1)
    return [f"shape: capsule, length: 1.5 m, diameter: 0.5 m, heading: {place.uniform(0, 180):.0f} deg, "
            f"position: {{row: {place.uniform(0.1, 0.9) * side:.0f}, column: {place.uniform(0.1, 0.9) * side:.0f}}}"
            for _ in range(count)]


def measure(folder, side, objects, interactions):
    """Returns seconds and megabytes of the fastest of three runs."""
    write_scene(folder / "scene.yaml", side, objects, interactions)
    runs = []
    for _ in range(3):
        subprocess.run([COMMAND, "run", folder / "scene.yaml", "-o", folder / "result", "--quiet", "--overwrite",
                        "--set", f"injection.seed={len(runs) + 1}"], check=True)
        found = json.loads((folder / "result" / "run.json").read_text())
        runs.append((found["times_s"]["total"], found["peak_memory_bytes"] / 1e6))
    return min(runs)


def rows(folder):
    for side in (256, 512, 1024, 2048, 4096):
        yield f"{side} × {side} pixels, one capsule", side, capsules(side, 1)
    for count in (10, 30, 100):
        yield f"1024 × 1024 pixels, {count} capsules", 1024, capsules(1024, count)
    for around, across in ((100, 25), (320, 80), (1000, 250), (3200, 800)):
        write_ring(folder / "ring.stl", around, across)
        yield (f"400 × 400 pixels, a mesh of {2 * around * across:,} triangles", 400,
               ["shape: mesh, mesh: ring.stl, position: {row: 200, column: 200}"])


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    print("\n| scene | one interaction | two | memory |\n|---|---|---|---|")
    for what, side, objects in rows(folder):
        one, two = (measure(folder, side, objects, interactions) for interactions in (1, 2))
        print(f"| {what} | {one[0]:.2f} s | {two[0]:.2f} s | {two[1]:.0f} MB |", flush=True)
