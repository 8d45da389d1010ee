"""Tests the scripts of tools/slurm and the commands of its README.md on a Slurm cluster of their own."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile

import numpy
import pytest

import cluster
import images
from cluster import wait_for
from conftest import COMMAND
from test_campaign import contents as data_set
from test_run import contents

SCRIPTS = pathlib.Path(os.environ["SONJECT_SOURCE"]) / "tools" / "slurm"
README = (SCRIPTS / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^    (.*)$", README, re.M)
# Enough rays for tracing a part in two slices, with time to end it in the second.
MANY_RAYS = "injection: {rays: 512}\n"
TOLD_OFTEN = "--verbose --checkpoint 1e-9"

CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: 6
chip: {rows: 64, columns: 64}
splits: {all: 1}
swaths: [{path: swath.png}]
targets: [{class: ball, object: {shape: sphere, diameter: 0.3 m}}]
"""


def documented(*words):
    """Returns the README's first command that has all the words."""
    return next(line for line in COMMANDS if all(word in line for word in words))


def checkpoints(folder, shard):
    return sorted((folder / "out" / "work").glob(f"shard-{shard}-of-4-*-*[0-9].sums"))


@pytest.fixture(scope="module")
def named(environment, tmp_path_factory):
    """Returns an environment in which PATH finds the command by its name."""
    folder = tmp_path_factory.mktemp("path")
    (folder / "sonject").symlink_to(COMMAND)
    return {**environment, "PATH": f"{folder}:{cluster.PATH}"}


@pytest.fixture(scope="module")
def slurm(named):
    """Starts Slurm's daemons. Their folder is in /tmp, since programs such as a job's script may be
    forbidden in TMPDIR."""
    reason = cluster.why_not()
    if reason:
        pytest.skip(reason)
    folder = tempfile.mkdtemp(prefix="slurm-", dir="/tmp")
    daemons = cluster.Cluster(folder, named)
    try:
        daemons.start()
        yield daemons
    finally:
        daemons.stop()
        shutil.rmtree(folder)


@pytest.fixture
def project(scene, tmp_path):
    """Makes a folder as the README expects it."""
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "slurm").symlink_to(SCRIPTS)
    return tmp_path


@pytest.fixture
def whole(sonject, scene, project):
    """Returns the files of a run in one go."""
    scene.write_text(scene.read_text() + MANY_RAYS)
    sonject.done("run", scene, "-o", "whole", "--quiet")
    return contents(project / "whole")


class Parts:
    """The parts of a run as the tasks of an array, and the job that merges them."""

    def __init__(self, slurm, folder, tasks):
        lines = documented("sbatch", "--array=1-4", " run "), documented("sbatch", "afterany")
        script = "\n".join(lines).replace("=1-4", f"={tasks}")
        script = script.replace("-o out", f"-o out {TOLD_OFTEN}")
        said = slurm.call("bash", "-euc", script + "\necho $array", cwd=folder)
        self.merge, self.array = re.fullmatch(r"Submitted batch job (\d+)\n(\d+)\n", said).groups()
        self.slurm, self.folder = slurm, folder
        self.stopped = []
        self.started_after = None

    def task(self, shard):
        return self.slurm.job(f"{self.array}_{shard}")

    def log(self, shard):
        return (self.folder / f"slurm-{self.array}_{shard}.out").read_text()

    def renderer(self, shard):
        """Returns the process number of a task's sonject, or None before it runs."""
        variables = (f"SLURM_ARRAY_JOB_ID={self.array}", f"SLURM_ARRAY_TASK_ID={shard}")
        found = cluster.processes_with(self.slurm.mark, *variables)
        return next((process for process in found if is_sonject(process)), None)

    def freeze(self, *shards):
        """Stops the tasks' sonjects as soon as each has saved its first slice. Returns their process
        numbers, or None if one had saved more by then because this process waited for the machine."""
        stopped = {}

        def are_stopped():
            for shard in set(shards) - set(stopped):
                if checkpoints(self.folder, shard):
                    process = stopped[shard] = self.renderer(shard)
                    if process:
                        cluster.send(process, signal.SIGSTOP)
            return len(stopped) == len(shards)

        wait_for("checkpoints", are_stopped, 10)
        in_time = all(process and has_stopped(process) and len(checkpoints(self.folder, shard)) == 1
                      for shard, process in stopped.items())
        self.stopped = [process for process in stopped.values() if process]
        return [stopped[shard] for shard in shards] if in_time else None

    def withdraw(self, shards):
        """Cancels the job and removes its files, as if these parts had never begun."""
        self.slurm.try_call("scancel", self.array, self.merge)
        cluster.kill(self.stopped)
        wait_for("the end of an array", lambda: not (self.slurm.queue(self.array) or
                                                     self.slurm.queue(self.merge)))
        for shard in shards:
            for path in checkpoints(self.folder, shard):
                path.unlink()

    def merge_early(self):
        """Lets Slurm start the merge while tasks are left, and waits until the merge is put back."""
        self.slurm.call("scontrol", "update", f"jobid={self.merge}", "dependency=")
        wait_for("a merge that is put back", lambda: self.slurm.job(self.merge)["Restarts"] == "1")
        assert self.slurm.queue(self.array)

    def is_merged(self):
        """Returns whether the merge has ended. Spares a requeued merge the two minutes in the queue."""
        merge = self.slurm.job(self.merge)
        put_back = merge["Restarts"]
        if (merge["Reason"] == "BeginTime" and not self.slurm.queue(self.array)
                and put_back != self.started_after):
            self.slurm.start_again(self.merge)
            self.started_after = put_back
        return merge["JobState"] in ("COMPLETED", "FAILED")

    def wait(self):
        """Waits for the end of the merge. Returns its output and its exit code."""
        wait_for("the merge", self.is_merged)
        code = int(self.slurm.job(self.merge)["ExitCode"].split(":")[0])
        return (self.folder / f"slurm-{self.merge}.out").read_text(), code


def start_and_freeze(slurm, folder, tasks, *shards):
    """Returns the parts of a run, and the process numbers of those that are stopped after one slice."""
    for _ in range(5):
        parts = Parts(slurm, folder, tasks)
        processes = parts.freeze(*shards)
        if processes:
            return parts, processes
        parts.withdraw(tasks.split(","))
    raise AssertionError("parts were never stopped in time")


def has_stopped(process):
    """Waits until a signal has stopped the process. Returns False if the process has ended instead."""

    def state():
        try:
            told = pathlib.Path(f"/proc/{process}/stat").read_text()
        except OSError:
            return "ended"
        return told.rpartition(")")[2].split()[0].replace("Z", "ended")

    return wait_for("a stopped process", lambda: state() in ("T", "ended") and state()) == "T"


def was_asked_to_end(process):
    """Returns true if SIGTERM waits for a stopped process, or if the process runs on or has ended."""
    try:
        told = pathlib.Path(f"/proc/{process}/status").read_text()
    except OSError:
        return True
    waiting = int(re.search(r"^ShdPnd:\s*(\w+)", told, re.M)[1], 16)
    return waiting >> (signal.SIGTERM - 1) & 1 or not re.search(r"^State:\s*T", told, re.M)


def is_sonject(process):
    try:
        return os.path.samefile(f"/proc/{process}/exe", COMMAND)
    except OSError:  # the process has ended
        return False


def test_evicted_and_killed_parts_go_on_and_missing_ones_are_named(slurm, project, whole):
    parts, (evicted, killed) = start_and_freeze(slurm, project, "1,3", 1, 3)
    slurm.call("scontrol", "requeue", f"{parts.array}_1")
    wait_for("Slurm's signal", lambda: was_asked_to_end(evicted))
    cluster.send(evicted, signal.SIGCONT)
    os.kill(killed, signal.SIGKILL)
    slurm.start_again(f"{parts.array}_1")
    slurm.start_again(f"{parts.array}_3")
    said, code = parts.wait()
    assert code == 3 and "out/work: of 4 shards, these are missing: 2, 4;" in said
    assert "stopped; run the same command again" in parts.log(1)
    for shard in (1, 3):
        assert parts.task(shard)["Restarts"] == "1"
        assert parts.log(shard).count("continues the work in out/work") == 1
    # The other parts. One is asked to stop, as Slurm does before the time limit.
    parts, (asked,) = start_and_freeze(slurm, project, "2,4", 2)
    parts.merge_early()
    slurm.call("scancel", "--batch", "--signal=USR1", f"{parts.array}_2")
    wait_for("Slurm's signal", lambda: was_asked_to_end(asked))
    cluster.send(asked, signal.SIGCONT)
    slurm.start_again(f"{parts.array}_2")
    said, code = parts.wait()
    assert code == 0 and said.endswith("sonject: the result is in out\n")
    assert said.startswith(f"merge.sh: job {parts.array} may not have ended")
    assert "stopped; run the same command again" in parts.log(2)
    assert contents(project / "out") == whole


@pytest.mark.parametrize("squeue, begins", [
    ("echo COMPLETED; echo FAILED", True),
    ("echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1", True),
    ("echo COMPLETED; echo PENDING", False),
    ("echo COMPLETED; echo REQUEUED", False),
    ("echo 'slurm_load_jobs error: Socket timed out' >&2; exit 1", False),
])
def test_a_merge_begins_only_when_every_task_is_known_to_have_ended(tmp_path, squeue, begins):
    for name, script in (("squeue", squeue), ("scontrol", "echo put back"),
                         ("sonject", "echo merged")):
        (tmp_path / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / name).chmod(0o755)
    answer = subprocess.run(["sh", SCRIPTS / "merge.sh", "out"], text=True, capture_output=True,
                            env={"PATH": f"{tmp_path}:{cluster.PATH}", "SLURM_JOB_ID": "8",
                                 "SLURM_JOB_DEPENDENCY": "afterany:7"}, check=True)
    assert answer.stdout == ("merged\n" if begins else "put back\n")


@pytest.fixture
def in_parallel(project, named):
    if not shutil.which("parallel", path=cluster.PATH):
        pytest.skip("not installed: parallel")

    def run(command):
        answer = subprocess.run(["bash", "-c", command], cwd=project, env=named, text=True,
                                capture_output=True, timeout=600)
        assert answer.returncode == 0, answer.stderr

    return run


def test_the_line_for_gnu_parallel_makes_a_run(sonject, scene, project, in_parallel):
    sonject.done("run", scene, "-o", "whole")
    in_parallel(documented("parallel", " run "))
    assert contents(project / "out") == contents(project / "whole")


def test_the_line_for_gnu_parallel_makes_a_campaign(sonject, swath, project, in_parallel):
    grey = numpy.clip(numpy.rint(swath * 255), 1, 255).astype(numpy.uint8)
    (project / "swath.png").write_bytes(images.png_bytes(grey))
    (project / "campaign.yaml").write_text(CAMPAIGN)
    sonject.done("campaign", "campaign.yaml", "-o", "whole")
    in_parallel(documented("parallel", " campaign "))
    made, wanted = data_set(project / "data"), data_set(project / "whole")
    assert made == wanted and any(name.endswith(".png") for name in made)
