"""Times of forming an image anew, at two thirds of the bandwidth, beside those of whole runs at that
bandwidth: figure 7 of the paper with three interactions, and the same with so many rays that tracing
is nearly all of a run. One process, warm program caches. Prints one line each."""
import os
import pathlib
import subprocess
import tempfile
import time

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
COMMAND = os.environ["SONJECT_COMMAND"]


def time_stages(folder, swath, rays):
    import sonject

    chosen = {
        "input.path": swath,
        "injection.interactions": 3,
        "injection.rays": rays,
    }
    narrower = {"sonar.bandwidth": "20 kHz"}
    scene_file = SOURCE / "tools" / "scenes" / "figure7.yaml"
    impulses = folder / f"{rays}.h5"
    sonject.trace(sonject.Scene.read(scene_file, chosen), impulses)
    number = iter(range(1000))

    def run():
        scene = sonject.Scene.read(scene_file, {**chosen, **narrower})
        sonject.run(scene, folder / f"{rays} {next(number)}")

    def form():
        sonject.form(impulses, folder / f"{rays} {next(number)}", narrower)

    def best_time(action, repeats):
        times = []
        for _ in range(repeats):
            start = time.perf_counter()
            action()
            times.append(time.perf_counter() - start)
        return min(times)

    whole = best_time(run, 2 if rays > 1 else 5)
    again = best_time(form, 5)
    print(f"figure 7, three interactions, {rays} times the rays: a run {whole:.3f} s, its image formed "
          f"anew {again:.3f} s ({again / whole:.3f}), from {impulses.stat().st_size / 1e6:.1f} MB")


with tempfile.TemporaryDirectory() as name:
    swath = pathlib.Path(name) / "swath.png"
    subprocess.run([COMMAND, "seabed", "-o", swath, "--rows", "472", "--columns", "512",
                    "--first-range", "43.6125"], check=True)
    for rays in (1, 64):
        time_stages(pathlib.Path(name), swath, rays)
