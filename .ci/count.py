"""Counts the results in meson's test logs: count.py [--require SUITE ...] [--other NAME STATUS] -- LOG ...

Prints which tests pytest skipped and why, which tests failed, and at the end "N passed, N failed, N
skipped". --other: a check by another program, which passed if STATUS is 0. A missing log counts as
failed, and so does a required suite that no log mentions. Exits with 1 if anything failed.
"""

import argparse
import json
import pathlib
import re
import sys

PASSED = {"OK", "EXPECTEDFAIL"}


def suites_of(name):
    """Returns the suites of a test that meson calls "project:suite+suite / name"."""
    before, separator, _ = name.partition(" / ")
    if not separator:
        return set()
    return set(before.partition(":")[2].split("+"))


def read_log(path):
    """Yields (name, result, output) of each test in the log."""
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.strip():
                test = json.loads(line)
                yield test["name"], test["result"], test.get("stdout", "")


def skipped_within(output):
    """Returns the tests that "pytest -rs" reports as skipped, with reasons."""
    return re.findall(r"^SKIPPED (\[\d+\] .*)$", output, flags=re.M)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--require", nargs="+", default=[], metavar="SUITE")
    parser.add_argument("--other", nargs=2, default=[], metavar=("NAME", "STATUS"))
    parser.add_argument("logs", nargs="+", metavar="LOG", type=pathlib.Path)
    options = parser.parse_args()
    passed, skipped, failures, seen = 0, 0, [], set()
    for log in options.logs:
        if not log.is_file():
            failures.append(f"{log}: there is no such log: the build failed or no test was run")
            continue
        for name, result, output in read_log(log):
            for what in skipped_within(output):
                print(f"{log.parent.parent}: {name}: skipped within it: {what}")
            if result == "SKIP":
                skipped += 1
                continue
            seen |= suites_of(name)
            if result in PASSED:
                passed += 1
            else:
                failures.append(f"{log.parent.parent}: {name}: {result}")
    if options.other:
        name, status = options.other
        passed += status == "0"
        failures += [] if status == "0" else [f"{name}: failed"]
    for suite in options.require:
        if suite not in seen:
            failures.append(f"suite {suite} was not run")
    for failure in failures:
        print(failure)
    print(f"{passed} passed, {len(failures)} failed, {skipped} skipped")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
