"""Tests of runs that are split, stopped and continued. Their files are always those of a run in one go."""

import json
import random
import shutil
import signal
import subprocess
import time

import pytest

from conftest import COMMAND, assert_refused, files_below, make_swath, write_scene
from test_run import RESULTS, contents
from test_stages import command

# Enough rays to cut a launch into slices, between which a run can stop.
MANY_RAYS = ["--set", "injection.rays=128"]


def checkpoints(folder):
    return sorted((folder / "work").glob("*.sums"))


@pytest.fixture(scope="module")
def wholes(tmp_path_factory, environment):
    """Returns the files of a run in one go, and those of one with many rays."""
    folder = tmp_path_factory.mktemp("whole")
    write_scene(folder, make_swath())
    found = []
    for name, options in (("whole", []), ("many", MANY_RAYS)):
        subprocess.run([COMMAND, "run", "scene.yaml", "-o", name, "--quiet", *options], cwd=folder,
                       env=environment, check=True)
        found.append(contents(folder / name))
    return found


@pytest.fixture
def whole(wholes):
    return wholes[0]


def test_what_shards_lack_is_named_and_the_rest_is_a_run(sonject, scene, tmp_path, whole):
    folder = tmp_path / "result"
    assert_refused(sonject("merge", "result"), 3, "result/work", "holds no shards")
    for shard in (3, 1):
        answer = sonject("run", scene, "-o", "result", "--shard", f"{shard}/4")
        assert (answer.returncode, answer.stdout) == (0, "")
        assert answer.stderr == "sonject: the shard is done; after all shards, run sonject merge result\n"
    assert_refused(sonject("merge", "result"), 3, "of 4 shards, these are missing: 2, 4;")
    stopped = sonject("run", scene, "-o", "result", "--shard", "2/4", "--exit-after", "1e-9")
    assert stopped.returncode == 85
    command(sonject, "run", scene, "-o", "result", "--shard", "4/4")
    assert_refused(sonject("merge", "result"), 3, "of 4 shards, these are missing: 2 (not finished);")
    # Another process finishes the shard meanwhile. Running the shard again changes nothing.
    other = tmp_path / "other"
    command(sonject, "run", scene, "-o", "other", "--shard", "2/4")
    (complete,) = checkpoints(other)
    complete.rename(folder / "work" / complete.name)
    before = {path: path.stat().st_mtime_ns for path in checkpoints(folder)}
    command(sonject, "run", scene, "-o", "result", "--shard", "2/4")
    assert before == {path: path.stat().st_mtime_ns for path in checkpoints(folder)}
    assert {path.name for path in folder.iterdir()} == {"work"}
    command(sonject, "merge", "result")
    assert {path.name for path in folder.iterdir()} == RESULTS
    assert contents(folder) == whole
    for again in (["merge", "result"], ["run", scene, "-o", "result"],
                  ["run", scene, "-o", "result", "--shard", "1/4"]):
        answer = sonject(*again)
        assert answer.returncode == 0 and "already" in answer.stderr
    # merge checks a merged folder, too
    (folder / "shadow.png").rename(tmp_path / "away")
    assert_refused(sonject("merge", "result"), 3, "result: is already merged, but shadow.png")
    (tmp_path / "away").rename(folder / "shadow.png")
    labelled = sonject("merge", "result", "--labels", "yolo")
    assert_refused(labelled, 3, "result: is already merged, without those labels")
    assert {path.name for path in folder.iterdir()} == RESULTS


def test_what_is_not_a_shard_of_the_run_is_refused(sonject, scene, tmp_path, whole):
    for shard in ("1/2", "2/2"):
        command(sonject, "run", scene, "-o", "result", "--shard", shard)
    first, second = checkpoints(tmp_path / "result")
    sound = first.read_bytes()
    changed = bytearray(sound)
    changed[len(sound) // 2] ^= 1
    for bad in (sound[: len(sound) // 2], bytes(changed)):  # tests/unit/test_sums_file.c has others
        first.write_bytes(bad)
        assert_refused(sonject("merge", "result"), 3, first.name, "damaged, or cut short")
        assert second.exists() and not (tmp_path / "result" / "run.json").exists()
    first.unlink()
    old = first.with_suffix(".stint")
    old.write_bytes(b"sonject stint 2\n" + sound[16:])
    assert_refused(sonject("merge", "result"), 3, old.name, "trace again")
    old.rename(first)
    # Running a shard again replaces a damaged file.
    answer = sonject("run", scene, "-o", "result", "--shard", "1/2", "--verbose")
    assert answer.returncode == 0 and "was damaged: it is traced again" in answer.stderr
    assert first.read_bytes() == sound
    first.write_bytes(second.read_bytes())
    assert_refused(sonject("merge", "result"), 3, first.name, "another shard's")
    answer = sonject("run", scene, "-o", "result", "--shard", "1/2")
    assert_refused(answer, 3, first.name, "another shard's")
    first.write_bytes(sound)
    # A shard of another scene cannot be merged, and no run goes on with it.
    command(sonject, "run", scene, "-o", "other", "--shard", "1/2", "--seed", "9")
    foreign = checkpoints(tmp_path / "other")[0].read_bytes()
    first.write_bytes(foreign)
    assert_refused(sonject("merge", "result"), 3, "work/shard-", "another scene or image")
    answer = sonject("run", scene, "-o", "result", "--shard", "1/2")
    assert_refused(answer, 3, first.name, "another scene or image")
    first.write_bytes(sound)
    for other in (["--shard", "1/3"], [], ["--seed", "9"]):
        answer = sonject("run", scene, "-o", "result", *other)
        assert_refused(answer, 3, "result/work", "2 shards")
    command(sonject, "merge", "result")
    assert contents(tmp_path / "result") == whole


def test_shards_replace_another_result_once_they_are_told_to(sonject, scene, tmp_path, whole):
    command(sonject, "run", scene, "-o", "result", "--seed", "9")
    for shard in ("1/2", "2/2"):
        answer = sonject("run", scene, "-o", "result", "--shard", shard)
        assert_refused(answer, 2, "differs in injection.seed (9 there, 1 here)")
        command(sonject, "run", scene, "-o", "result", "--shard", shard, "--overwrite")
    command(sonject, "merge", "result")
    assert contents(tmp_path / "result") == whole


def test_a_run_that_stops_by_itself_goes_on(sonject, scene, tmp_path, wholes):
    folder = tmp_path / "result"
    for stops in range(100):
        answer = sonject("run", scene, "-o", "result", *MANY_RAYS, "--exit-after", "1e-9")
        if answer.returncode == 0:
            break
        assert answer.returncode == 85
        assert answer.stderr == "sonject: stopped; run the same command again\n"
        assert len(checkpoints(folder)) == stops + 1
        assert {path.name for path in folder.iterdir()} == {"work"}
    assert stops > 1
    assert contents(folder) == wholes[1]
    assert {path.name for path in folder.iterdir()} == RESULTS


def test_what_a_run_of_another_scene_left_is_dropped(sonject, scene, tmp_path, whole):
    assert sonject("run", scene, "-o", "result", "--seed", "9", "--exit-after",
                   "1e-9").returncode == 85
    command(sonject, "run", scene, "-o", "result")
    assert contents(tmp_path / "result") == whole


def test_killed_shards_go_on_with_what_they_had_kept(scene, tmp_path, environment, sonject, wholes):
    """Kills each process at a random moment after it has saved another slice or is done."""
    chance = random.Random(5)
    folder = tmp_path / "result"
    for shard in ("1/2", "2/2"):
        arguments = ["run", scene, "-o", "result", "--quiet", *MANY_RAYS, "--shard", shard]
        for _ in range(2):
            before = len(checkpoints(folder))
            process = subprocess.Popen([COMMAND, *map(str, arguments), "--checkpoint", "1e-9"],
                                       cwd=tmp_path, env=environment)
            while process.poll() is None and len(checkpoints(folder)) == before:
                time.sleep(0.002)
            time.sleep(chance.uniform(0, 0.05))
            process.kill()
            process.wait()
        assert checkpoints(folder)
        command(sonject, *arguments)
    command(sonject, "merge", "result")
    assert contents(folder) == wholes[1]
    assert {path.name for path in files_below(folder)} == RESULTS


def test_of_two_same_runs_at_once_both_end_well(scene, tmp_path, environment, sonject, wholes):
    """Holds the slower one while the other ends, which removes the checkpoints of both."""
    folder, arguments = tmp_path / "result", ["run", scene, "-o", "result", *MANY_RAYS]
    process = subprocess.Popen([COMMAND, *map(str, arguments), "--checkpoint", "1e-9"], cwd=tmp_path, env=environment,
                               stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not list(folder.glob("work/shard-*.sums")):
        time.sleep(0.002)
    process.send_signal(signal.SIGSTOP)
    assert checkpoints(folder)
    command(sonject, *arguments)
    process.send_signal(signal.SIGCONT)
    told = process.communicate()[1]
    assert process.returncode == 0 and "already" in told, told
    assert contents(folder) == wholes[1]


def test_shards_know_their_scene_from_elsewhere(sonject, scene, tmp_path, whole):
    for shard in ("1/2", "2/2"):
        command(sonject, "run", "scene.yaml", "-o", "result", "--shard", shard)
    (tmp_path / "elsewhere").mkdir()
    sonject.done("merge", "../result", folder="elsewhere")
    assert contents(tmp_path / "result") == whole
    answer = sonject("run", "scene.yaml", "-o", "result")
    assert answer.returncode == 0 and "already" in answer.stderr


def test_shards_of_bands_are_merged_at_once(sonject, scene, tmp_path):
    bands = ["--set", "bands={low: {sonar: {frequency: 90 kHz}}, high: {}}"]
    folder, low, high = (tmp_path / name for name in ("parts", "parts/low", "parts/high"))
    command(sonject, "run", scene, "-o", "whole", *bands)
    command(sonject, "run", scene, "-o", "parts", *bands, "--shard", "2/2")
    assert_refused(sonject("merge", "parts"), 3, "parts/high/work: of 2 shards, these are missing: 1;")
    assert [path.name for path in folder.glob("*/*")] == ["work", "work"]
    command(sonject, "run", scene, "-o", "parts", *bands, "--shard", "1/2")
    high.rename(tmp_path / "away")
    refused = sonject("merge", "parts")
    assert refused.returncode == 3 and "parts: holds no shards of band high" in refused.stderr
    shutil.copytree(low, high)  # a result, but of the other band
    refused = sonject("merge", "parts")
    assert refused.returncode == 3 and "parts: holds no shards of band high" in refused.stderr
    shutil.rmtree(high)
    (tmp_path / "away").rename(high)
    command(sonject, "merge", "parts")
    for band in (low, high):
        assert {path.name for path in band.iterdir()} == RESULTS
        assert contents(band) == contents(tmp_path / "whole" / band.name)
        assert json.loads((band / "run.json").read_text())["band"] == band.name
    answer = sonject("merge", "parts")
    assert answer.returncode == 0 and "already holds" in answer.stderr


def test_an_accuracy_takes_as_many_rays_in_shards_and_stages(sonject, scene, tmp_path):
    """Pilot runs decide the number of rays before the work is split."""
    asked = ["--set", "injection.accuracy=4 %"]
    answer = sonject("run", scene, "-o", "one", "--verbose", *asked)
    assert answer.returncode == 0
    rays = json.loads((tmp_path / "one/run.json").read_text())["options"]["ray_scale"]
    error = json.loads((tmp_path / "one/truth.json").read_text())["energy_error"]
    assert rays != 1 and 0 < error < 0.04
    assert f"accuracy: energies of changed pixels have errors of {100 * error:.2g} %" in answer.stderr
    for shard in ("1/2", "2/2"):
        command(sonject, "run", scene, "-o", "parts", "--shard", shard, *asked)
    command(sonject, "merge", "parts")
    command(sonject, "trace", scene, "-o", "impulses.sums", *asked)
    command(sonject, "form", "impulses.sums", "-o", "formed")
    whole = contents(tmp_path / "one")
    assert contents(tmp_path / "parts") == whole
    assert contents(tmp_path / "formed") == whole
    command(sonject, "run", scene, "-o", "given", "--set", f"injection.rays={rays}")
    given = json.loads((tmp_path / "given/truth.json").read_text())
    assert given["energy_error"] is None
    assert (tmp_path / "given/energy.tif").read_bytes() == (tmp_path / "one/energy.tif").read_bytes()
    assert_refused(sonject("run", scene, "-o", "both", *asked, "--set", "injection.rays=2"), 3,
                   "injection.rays: accuracy decides the number of rays")


def test_echoes_between_objects_are_the_same_in_shards(sonject, scene, tmp_path):
    """Specular paths by way of two objects lie in a few cells of large grids, of which shards keep the filled ones."""
    scene.write_text(scene.read_text() + """
  - {shape: cylinder, length: 1 m, diameter: 0.4 m, heading: 10 deg, material: {reflection: 1, roughness: 0, lambert: 0},
     position: {row: 24, column: 40}}
""")
    asked = ["--set", "injection.interactions=2", "--set", "objects[0].material={reflection: 1, roughness: 0, lambert: 0}"]
    command(sonject, "run", scene, "-o", "one", *asked)
    command(sonject, "run", scene, "-o", "direct", *asked, "--set", "injection.interactions=1")
    for shard in ("1/3", "2/3", "3/3"):
        command(sonject, "run", scene, "-o", "parts", "--shard", shard, *asked)
    command(sonject, "merge", "parts")
    assert contents(tmp_path / "parts") == contents(tmp_path / "one")
    patches = [(tmp_path / name / "patch.tif").read_bytes() for name in ("one", "direct")]
    assert patches[0] != patches[1]
