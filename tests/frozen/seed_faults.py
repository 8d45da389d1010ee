#!/usr/bin/env python3
"""Makes the faults of faults.md, one at a time, in a copy of the tree, and tells which ones the tests catch.

    seed_faults.py                all, after a run without any fault of all tests that the table names
    seed_faults.py 3 18           these alone, without that run
    --scratch DIR                 keeps copy and build there for the next time

For each fault the test that caught it last is built and run. If that test passes, all suites run up to the
first failure. Prints one line each: the test that caught it, survived, does not build, or stale, if the code
no longer reads as in the table. Exit status: 0 if all were caught."""

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROW = re.compile(r"\| (\d+) \| (.+?) \| `(.+?)` \| `(.+?)` \| (?:`(.+?)`)? ?\| (.+?) \|$", re.M)
FAILED = ("FAIL", "ERROR", "TIMEOUT")
SUITES = ["unit", "kernel", "physics", "cli", "fault", "python"]  # the quickest first


def done(tree, *command):
    return subprocess.run(command, cwd=tree, stdout=subprocess.DEVNULL).returncode == 0


def make_copy(tree):
    """Copies the tracked files as they are now. A file that did not change keeps its time."""
    names = subprocess.check_output(["git", "ls-files", "-z"], cwd=HERE.parents[1], text=True)
    for name in filter(None, names.split("\0")):
        source, copy = HERE.parents[1] / name, tree / name
        if not copy.exists() or copy.read_bytes() != source.read_bytes():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)
    if not (tree / "build" / "build.ninja").exists():
        if not done(tree, "meson", "setup", "build", "-Dtests=enabled"):
            sys.exit("seed_faults.py: meson setup failed")


def targets_of(tree, test):
    """Returns the files that ninja must build for a test, "suite / name". Exits if there is no such test."""
    suite, name = test.split(" / ")
    told = {kind: json.loads((tree / "build" / "meson-info" / f"intro-{kind}.json").read_text())
            for kind in ("tests", "targets")}
    files = {target["id"]: target["filename"] for target in told["targets"]}
    for entry in told["tests"]:
        if entry["name"] == name and f"sonject:{suite}" in entry["suite"]:
            return [str(pathlib.Path(file).relative_to((tree / "build").resolve()))
                    for key in entry["depends"] for file in files[key]]
    return sys.exit(f"seed_faults.py: there is no test {test}")


def failure(tree, *chosen):
    """Returns the first test that fails, or "" if none does."""
    command = ["meson", "test", "-C", "build", "--no-rebuild", "--maxfail", "1", *chosen]
    if done(tree, *command):
        return ""
    log = (tree / "build" / "meson-logs" / "testlog.json").read_text().splitlines()
    failed = [test["name"] for test in map(json.loads, log) if test["result"] in FAILED]
    return failed[0] if failed else " ".join(chosen)


def outcome(tree, test):
    if not done(tree, "ninja", "-C", "build", *targets_of(tree, test)):
        return "does not build"
    suite, name = test.split(" / ")
    if failure(tree, "--suite", suite, name):
        return f"caught by {test}"
    if not done(tree, "ninja", "-C", "build"):
        return "does not build"
    for suite in SUITES:
        if name := failure(tree, "--suite", suite):
            return f"caught by {name}, no longer by {test}"
    return "survived"


def with_fault(tree, name, old, new, test):
    path = tree / name
    sound = path.read_text() if path.exists() else ""
    if sound.count(old) != 1:
        return "stale"
    path.write_text(sound.replace(old, new))
    try:
        return outcome(tree, test)
    finally:
        path.write_text(sound)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("numbers", nargs="*", type=int)
    parser.add_argument("--scratch", type=pathlib.Path)
    options = parser.parse_args()
    rows = ROW.findall((HERE / "faults.md").read_text())
    caught = True
    with tempfile.TemporaryDirectory(prefix="faults-") as temporary:
        tree = (options.scratch or pathlib.Path(temporary)).resolve()
        make_copy(tree)
        for test in () if options.numbers else sorted({row[-1] for row in rows}):
            suite, name = test.split(" / ")
            built = done(tree, "ninja", "-C", "build", *targets_of(tree, test))
            if not built or failure(tree, "--suite", suite, name):
                sys.exit(f"seed_faults.py: without any fault {test} fails")
        for number, claim, name, old, new, test in rows:
            if not options.numbers or int(number) in options.numbers:
                answer = with_fault(tree, name, old, new, test)
                print(f"{number:>2}  {answer}: {claim}", flush=True)
                caught = caught and answer.startswith("caught")
    return 0 if caught else 1


if __name__ == "__main__":
    sys.exit(main())
