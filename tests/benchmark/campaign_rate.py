"""Images a second of a campaign of 256 x 256 pixels, beside runs of the command on the same scenes,
one process each, what a process alone takes, and a sidescan's campaign. Warm program caches. SONJECT_BENCHMARK_SWATHS:
8 bit images, separated by ':', instead of swaths that sonject makes. Prints one line each."""
import json
import os
import pathlib
import subprocess
import tempfile
import time

from campaign_scene import CAMPAIGN, SCENE, SIDESCAN, SWATHS, swath_arguments

COMMAND = os.environ["SONJECT_COMMAND"]
IMAGES, RUNS = 100, 5


def command(folder, *arguments):
    start = time.perf_counter()
    subprocess.run([COMMAND, *map(str, arguments)], check=True, cwd=folder, capture_output=True)
    return time.perf_counter() - start


def swaths_in(folder):
    chosen = os.environ.get("SONJECT_BENCHMARK_SWATHS")
    if chosen:
        return [str(pathlib.Path(name).resolve()) for name in chosen.split(":")]
    for seed in range(len(SWATHS)):
        command(folder, *swath_arguments(seed))
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
        part for text in [*record["set"], f"input.path={record['swath']['path']}"]
        for part in ("--set", text))) for record in records]
    bare = min(command(folder, "devices") for _ in range(3))
    print(f"{IMAGES} images of 256 x 256: {inside['images_per_second']:.1f} a second, "
          f"{IMAGES / whole:.1f} with the process's start and the documents of the whole; "
          f"single runs {RUNS / sum(runs):.1f} a second, of which a process that does nothing "
          f"takes {bare:.2f} s")
    command(folder, "campaign", "sidescan_campaign.yaml", "-o", "sidescan")
    sidescan = json.loads((folder / "sidescan" / "times.json").read_text())
    print(f"{IMAGES} chips of a sidescan at 455 kHz: {sidescan['images_per_second']:.1f} a second")
