#!/usr/bin/env python3
"""Makes the faults of faults.md, one at a time, in a copy of the tree, and tells which the tests catch.

    seed_faults.py                all, after a run of all their suites without any fault
    seed_faults.py 3 17           these alone, without that run
    --scratch DIR                 keeps copy and build there for the next time

One line each: caught by which test, survived, does not build, or stale, if the code is no longer
what the table says. Exit status: 0 all were caught."""

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
ORDER = ["unit", "kernel", "physics", "cli"]  # the quickest first


def done(tree, *command):
    return subprocess.run(command, cwd=tree, stdout=subprocess.DEVNULL).returncode == 0


def make_copy(tree):
    """The tracked files as they are now; a file that is the same keeps its time."""
    names = subprocess.check_output(["git", "ls-files", "-z"], cwd=HERE.parents[1], text=True)
    for name in filter(None, names.split("\0")):
        source, copy = HERE.parents[1] / name, tree / name
        if not copy.exists() or copy.read_bytes() != source.read_bytes():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)
    if not (tree / "build" / "build.ninja").exists():
        if not done(tree, "meson", "setup", "build", "-Dtests=enabled"):
            sys.exit("seed_faults.py: meson setup failed")


def outcome(tree, suites):
    """Builds and runs the suites up to the first test that fails."""
    if not done(tree, "ninja", "-C", "build"):
        return "does not build"
    for suite in suites:
        test = ["meson", "test", "-C", "build", "--no-rebuild", "--maxfail", "1", "--suite", suite]
        if not done(tree, *test):
            log = (tree / "build" / "meson-logs" / "testlog.json").read_text().splitlines()
            failed = [test for test in map(json.loads, log) if test["result"] in FAILED]
            return "caught by " + (failed[0]["name"] if failed else suite)
    return "survived"


def with_fault(tree, name, old, new, suites):
    path = tree / name
    sound = path.read_text() if path.exists() else ""
    if sound.count(old) != 1:
        return "stale"
    path.write_text(sound.replace(old, new))
    try:
        return outcome(tree, suites)
    finally:
        path.write_text(sound)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("numbers", nargs="*", type=int)
    parser.add_argument("--scratch", type=pathlib.Path)
    options = parser.parse_args()
    caught = True
    with tempfile.TemporaryDirectory(prefix="faults-") as temporary:
        tree = options.scratch or pathlib.Path(temporary)
        make_copy(tree)
        if not options.numbers and (answer := outcome(tree, ORDER)) != "survived":
            sys.exit(f"seed_faults.py: without any fault: {answer}")
        for number, claim, name, old, new, suites in ROW.findall((HERE / "faults.md").read_text()):
            if not options.numbers or int(number) in options.numbers:
                answer = with_fault(tree, name, old, new, suites.split())
                print(f"{number:>2}  {answer}: {claim}", flush=True)
                caught = caught and answer.startswith("caught")
    return 0 if caught else 1


if __name__ == "__main__":
    sys.exit(main())
