"""Tests the command in a bad world: killed at any moment, twice at once, without files or rights."""

import hashlib
import os
import random
import resource
import shutil
import subprocess
import time

import pytest

from command_fixtures import COMMAND, assert_refused, make_swath, write_scene

# The number of runs that are killed. Each takes less time than a whole one.
KILLS = int(os.environ.get("SONJECT_KILLS", "8"))

# A prefix of the command, since root may write anywhere unless it gives these rights up.
WITHOUT_RIGHTS = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-all"]


def names(folder):
    """Returns the names of a folder's entries, none if there is no folder."""
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def digests(folder):
    """Returns each file's digest by its name. run.json tells times, so only its presence counts."""
    return {
        name: "" if name == "run.json" else hashlib.sha256((folder / name).read_bytes()).hexdigest()
        for name in names(folder) if (folder / name).is_file()
    }


def finals(folder):
    """Returns the digests of the files under final names."""
    return {name: digest for name, digest in digests(folder).items() if ".part" not in name}


@pytest.fixture(scope="module")
def reference(tmp_path_factory, environment):
    """The files that a run leaves, and its duration with full caches, s."""
    folder = tmp_path_factory.mktemp("reference")
    scene = write_scene(folder, make_swath())
    for name in ("first", "reference"):
        start = time.monotonic()
        subprocess.run([COMMAND, "run", scene, "-o", name, "--quiet"], cwd=folder, env=environment,
                       check=True)
    return digests(folder / "reference"), time.monotonic() - start


def start(arguments, tmp_path, environment):
    return subprocess.Popen(
        [COMMAND, *map(str, arguments)], cwd=tmp_path, env=environment,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def begin(scene, folder, tmp_path, environment):
    return start(["run", scene, "-o", folder], tmp_path, environment)


def test_killed_at_any_moment(reference, scene, tmp_path, environment, sonject):
    expected, duration = reference
    moments = random.Random(20240502)
    finished = 0
    for number in range(KILLS):
        process = begin(scene, "result", tmp_path, environment)
        # most of the files are written in the last third
        time.sleep(duration * (0.5 * moments.random() + 0.5 * (number % 2)))
        process.kill()
        process.communicate()
        left = finals(tmp_path / "result")
        assert left.items() <= expected.items()
        if "run.json" in left:
            assert left == expected
            finished += 1
            (tmp_path / "result").rename(tmp_path / f"finished{finished}")
    assert sonject("run", scene, "-o", "result").returncode == 0
    assert finals(tmp_path / "result") == expected


def test_a_merge_killed_at_any_moment(reference, scene, tmp_path, environment, sonject):
    """Kills merges after none, one, two ... results. Until all are written, the parts stay."""
    expected, _ = reference
    for part in ("1/2", "2/2"):
        assert sonject("run", scene, "-o", "parts", "--shard", part).returncode == 0
    for number in range(KILLS // 2):
        folder = tmp_path / f"merged{number}"
        shutil.copytree(tmp_path / "parts", folder)
        process = start(["merge", folder], tmp_path, environment)
        # compares names alone, since the working command renames files at any moment
        while len(names(folder) & set(expected)) < number and process.poll() is None:
            time.sleep(1e-3)
        process.kill()
        process.communicate()
        assert finals(folder).items() <= expected.items()
        answer = sonject("merge", folder)
        assert answer.returncode == 0, answer.stderr
        assert finals(folder) == expected


def test_two_at_once_in_one_folder(reference, scene, tmp_path, environment):
    expected, _ = reference
    for _ in range(2):
        both = [begin(scene, "result", tmp_path, environment) for _ in range(2)]
        for process in both:
            _, said = process.communicate()
            assert process.returncode == 0, said
        assert digests(tmp_path / "result") == expected
        (tmp_path / "result" / "run.json").unlink()
        (tmp_path / "result" / "work").mkdir()  # as a kill between two files would leave it


def test_few_open_files(reference, scene, tmp_path, sonject):
    """Expects all files, or one line that says what is missing."""
    expected, _ = reference
    codes = set()
    for number in (4, 6, 8, 12, 1024):  # drivers of GPUs need hundreds
        answer = sonject(
            "run", scene, "-o", f"result{number}",
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (number, number)))
        left = digests(tmp_path / f"result{number}")
        codes.add(answer.returncode)
        if answer.returncode == 0:
            assert left == expected
        else:
            assert answer.returncode in (3, 4, 5), answer.stderr
            assert answer.stderr.count("\n") == 1, answer.stderr
            assert left.items() <= expected.items()
    assert 0 in codes


@pytest.mark.parametrize("megabytes", [100, 200])
def test_little_memory_is_told_as_such(scene, sonject, megabytes):
    """The message must not tell users to install a driver."""
    def try_with_little(*arguments):
        limit = (megabytes << 20, megabytes << 20)
        return sonject(*arguments, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, limit))

    run = ["run", scene, "-o", "result"]
    assert_refused(try_with_little(*run, "--device", "pthread"), 5, "too little memory", "ulimit -v")
    answer = try_with_little(*run)  # each thread of native takes some memory
    if answer.returncode != 0:
        assert_refused(answer, 5, "memory")
    devices = try_with_little("devices")
    assert devices.returncode == 0 and "* native" in devices.stdout
    assert devices.stderr.startswith("sonject: note: too little memory"), devices.stderr


def test_without_opencl_there_is_native(scene, sonject, tmp_path):
    (tmp_path / "libOpenCL.so.1").write_bytes(b"")  # found before the real one
    without = {"changes": {"LD_LIBRARY_PATH": str(tmp_path)}}
    devices = sonject("devices", **without)
    assert (devices.returncode, devices.stderr) == (0, "")
    assert len(devices.stdout.splitlines()) == 2 and "* native" in devices.stdout
    assert sonject("run", scene, "-o", "result", **without).returncode == 0
    assert_refused(sonject("run", scene, "-o", "other", "--device", "pthread", **without), 4,
                   "no OpenCL device found", "native")


@pytest.mark.parametrize("is_made", [True, False])
def test_a_folder_that_may_not_be_written(scene, tmp_path, environment, is_made):
    folder = tmp_path / "closed"
    result = folder / "result"
    (result if is_made else folder).mkdir(parents=True)
    for path in (result, folder):
        if path.is_dir():
            path.chmod(0o555)
    prefix = WITHOUT_RIGHTS if os.geteuid() == 0 else []
    answer = subprocess.run(
        [*prefix, COMMAND, "run", str(scene), "-o", str(result)], cwd=tmp_path, env=environment,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    folder.chmod(0o755)
    assert_refused(answer, 5, str(result), "Permission denied")
    assert not result.is_dir() or not any(result.iterdir())
