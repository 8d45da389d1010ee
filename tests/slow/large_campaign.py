"""A campaign of a thousand images of 256 x 256 in one go, killed ten times and gone on with, and in
two shards that are merged: its rate, and whether all three data sets are the same byte for byte.

    python3 tests/slow/large_campaign.py build/tools/sonject FOLDER [SWATH ...]

SWATH: 8 bit images of at least 256 x 256 pixels, two at least for the two splits, without any four
that sonject makes. FOLDER, which is made, gets about 150 MB three times over and keeps them."""

import json
import pathlib
import random
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "benchmark"))
from campaign_scene import CAMPAIGN, SCENE, SWATHS, swath_arguments  # noqa: E402

IMAGES = 1000
KILLS = 10

MORE = """\
splits: {train: 0.8, test: 0.2}
clutter:
  number: {choice: [0, 1, 2]}
  alone: 0.1
  objects:
    - class: boulder
      object: {shape: ellipsoid, height: 0.4 m, material: rock}
      draw:
        length: {log_uniform: [0.4 m, 1.2 m]}
        width: {uniform: [0.4 m, 0.8 m]}
"""


def run(folder, *arguments):
    start = time.monotonic()
    subprocess.run([COMMAND, *map(str, arguments), "--quiet"], check=True, cwd=folder)
    return time.monotonic() - start


def make_swaths(folder):
    for seed in range(len(SWATHS)):
        subprocess.run([COMMAND, *swath_arguments(seed)], check=True, cwd=folder,
                       capture_output=True)
    return SWATHS


def files_of(folder):
    return {path.relative_to(folder): path for path in folder.rglob("*")
            if path.is_file() and path.name != "times.json"}


def expect_same(folder, name):
    one, other = files_of(folder / "whole"), files_of(folder / name)
    assert one.keys() == other.keys(), set(one) ^ set(other)
    for key, path in one.items():
        assert path.read_bytes() == other[key].read_bytes(), key
    print(f"{name}: all {len(one)} files are those of one run", flush=True)


def kill_and_go_on(folder, duration):
    chance = random.Random(11)
    kills = 0
    while kills < KILLS:
        process = subprocess.Popen([COMMAND, "campaign", "campaign.yaml", "-o", "killed", "--quiet"],
                                   cwd=folder)
        try:
            process.wait(chance.uniform(0.2, 2 * duration / (KILLS + 2)))
            break  # finished before the next kill
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            kills += 1
    made = len(list((folder / "killed").glob("*/records/*.json")))
    run(folder, "campaign", "campaign.yaml", "-o", "killed")
    print(f"killed {kills} times, the last time after {made} images", flush=True)


def main():
    folder = pathlib.Path(sys.argv[2])
    swaths = [str(pathlib.Path(name).resolve()) for name in sys.argv[3:]]
    folder.mkdir(parents=True)
    (folder / "scene.yaml").write_text(SCENE)
    swaths = [{"path": path} for path in swaths or make_swaths(folder)]
    (folder / "campaign.yaml").write_text(CAMPAIGN % ("scene.yaml", IMAGES, 256, 256, json.dumps(swaths)) + MORE)
    run(folder, "campaign", "campaign.yaml", "-o", "warm", "--set", "images=10")
    duration = run(folder, "campaign", "campaign.yaml", "-o", "whole")
    told = json.loads((folder / "whole" / "times.json").read_text())
    print(f"{IMAGES} images: {told['images_per_second']:.1f} a second, {IMAGES / duration:.1f} with "
          "the process's start and the documents of the whole", flush=True)
    kill_and_go_on(folder, duration)
    expect_same(folder, "killed")
    for shard in ("2/2", "1/2"):
        run(folder, "campaign", "campaign.yaml", "-o", "shards", "--shard", shard)
    run(folder, "merge", "shards")
    expect_same(folder, "shards")


if len(sys.argv) < 3:
    sys.exit(__doc__)
COMMAND = str(pathlib.Path(sys.argv[1]).resolve())
main()
