"""Measures a campaign's images per second at 256 x 256 pixels and compares it with runs of the command on the
same scenes, one process each, and with the time of a bare process. Measures a sidescan's campaign, too. Prints
one line each, with warm program caches. SONJECT_BENCHMARK_SWATHS may name 8-bit images, separated by ':', to be
used instead of swaths that sonject makes."""
import json
import os
import pathlib
import subprocess
import tempfile
import time

COMMAND = os.environ["SONJECT_COMMAND"]
IMAGES, RUNS = 100, 5

SCENE = """\
sonject: 1
input:
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 43.6 m}
  transfer: {kind: schlick, parameter: 3}
sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m, resolution: 4 cm}
"""

# A sidescan at high frequency, whose glints take most rays. Its chips have 96 x 160 pixels.
SIDESCAN = """\
sonject: 1
input:
  geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 15 m}
  transfer: {kind: schlick, parameter: 3}
sonar: {kind: real, array: {length: 0.8 m}, frequency: 455 kHz, bandwidth: 15 kHz, altitude: 6 m}
"""

CAMPAIGN = """\
sonject_campaign: 1
scene: %s
images: %d
chip: {rows: %d, columns: %d}
empty: 0.1
swaths: %s
draw:
  seabed.lambert: {uniform: [-30 dB, -24 dB]}
  objects[].heading: {uniform: [0 deg, 360 deg]}
  objects[].burial: {uniform: [0 cm, 10 cm]}
targets:
  - {class: capsule, object: {shape: capsule, length: 1.8 m, diameter: 0.4 m}}
  - {class: cylinder, object: {shape: cylinder, length: 1.2 m, diameter: 0.3 m}}
  - {class: ball, object: {shape: sphere, diameter: 0.5 m}}
"""

SWATHS = [f"swath{seed}.png" for seed in range(4)]


def command(folder, *arguments):
    start = time.perf_counter()
    subprocess.run([COMMAND, *map(str, arguments)], check=True, cwd=folder, capture_output=True)
    return time.perf_counter() - start


def swaths_in(folder):
    chosen = os.environ.get("SONJECT_BENCHMARK_SWATHS")
    if chosen:
        return [str(pathlib.Path(name).resolve()) for name in chosen.split(":")]
    for seed, swath in enumerate(SWATHS):
        command(folder, "seabed", "-o", swath, "--rows", 472, "--columns", 512, "--seed", seed)
    return SWATHS


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "scene.yaml").write_text(SCENE)
    swaths = [{"path": path} for path in swaths_in(folder)]
    (folder / "sidescan.yaml").write_text(SIDESCAN)
    for scene, size in ("scene", (256, 256)), ("sidescan", (96, 160)):
        text = CAMPAIGN % (f"{scene}.yaml", IMAGES, *size, json.dumps(swaths))
        (folder / f"{scene}_campaign.yaml").write_text(text)
    command(folder, "campaign", "scene_campaign.yaml", "-o", "warm", "--set", "images=10")
    whole = command(folder, "campaign", "scene_campaign.yaml", "-o", "set")
    inside = json.loads((folder / "set" / "times.json").read_text())
    records = [json.loads(path.read_text())
               for path in sorted(folder.glob("set/*/records/*.json"))[:RUNS]]
    runs = [command(folder, "run", "scene.yaml", "-o", f"run{record['id']}", *(
        part for text in record["set"] for part in ("--set", text))) for record in records]
    bare = min(command(folder, "devices") for _ in range(3))
    print(f"{IMAGES} images of 256 x 256: {inside['images_per_second']:.1f} a second, "
          f"{IMAGES / whole:.1f} with the process's start and the documents of the whole; "
          f"single runs {RUNS / sum(runs):.1f} a second, of which a process that does nothing "
          f"takes {bare:.2f} s")
    command(folder, "campaign", "sidescan_campaign.yaml", "-o", "sidescan")
    sidescan = json.loads((folder / "sidescan" / "times.json").read_text())
    print(f"{IMAGES} chips of a sidescan at 455 kHz: {sidescan['images_per_second']:.1f} a second")
