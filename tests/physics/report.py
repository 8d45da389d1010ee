"""Writes the validation report: figures that the physics tests measured, beside the expected ones.

    python3 tests/physics/report.py [BUILD] > report.md

runs the tests of the build folder ("build" by default) and writes a table for each. --log FILE takes
meson's log of an earlier run instead, BUILD/meson-logs/testlog.json. Fails if a test failed.

--page FILE writes the figures into the tables of that page, docs/validation.md, instead. The rows name
program and figure, and their choice stays. --check FILE writes nothing, and fails if the page says
anything else.
"""

import argparse
import collections
import json
import math
import pathlib
import re
import subprocess
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
NUMBER = r"([-+\w.]+)"
CLOSE = re.compile(rf"(?:.*: )?(.+?): {NUMBER}, expected {NUMBER} \+- {NUMBER}$")
BELOW = re.compile(rf"(?:.*: )?(.+?): {NUMBER}, to be below {NUMBER}$")


class Check:
    """The comparisons of one figure: their number, and the one that was nearest to its limit."""

    def __init__(self):
        self.count = 0
        self.share = -1.0
        self.cells = ()

    def add(self, share, cells):
        self.count += 1
        if not share <= self.share:
            self.share, self.cells = share, cells


def share_of(distance, room):
    return distance / room if room > 0 else float(distance > 0)


def read_checks(output):
    """Returns the checks in a program's output, {name: Check}."""
    checks = collections.defaultdict(Check)
    for line in output.splitlines():
        close, below = CLOSE.fullmatch(line), BELOW.fullmatch(line)
        if close:
            measured, expected, tolerance = map(float, close.groups()[1:])
            checks[close[1]].add(share_of(abs(measured - expected), tolerance),
                                 (close[2], close[3], f"± {close[4]}"))
        elif below:
            measured, limit = map(float, below.groups()[1:])
            checks[below[1]].add(share_of(max(measured, 0.0), limit),
                                 (below[2], f"below {below[3]}", ""))
    return checks


def first_comment(name):
    """Returns the first comment of the test's source."""
    source = FOLDER / f"test_{name}.c"
    text = source.read_text(encoding="utf-8") if source.is_file() else ""
    found = re.match(r"/\*(.*?)\*/", text, flags=re.S)
    return re.sub(r"\s*\n \*\s*", " ", found[1]).strip() if found else ""


def read_log(path):
    """Returns (name, passed, output) of the physics tests in meson's log, by name."""
    entries = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line]
    named = [(entry["name"].rpartition(" / "), entry) for entry in entries]
    return sorted((name, entry["result"] == "OK", entry.get("stdout", ""))
                  for (suites, _, name), entry in named if "physics" in suites)


def cell(text):
    return text.replace("|", "\\|")


def report(tests):
    """Returns the report's lines."""
    failed = [name for name, passed, _ in tests if not passed]
    compared = [read_checks(output) for _, _, output in tests]
    total = sum(check.count for checks in compared for check in checks.values())
    lines = ["# Validation report", "",
             f"{len(tests)} programs compared {total} figures with what is expected of them; "
             + (f"failed: {', '.join(failed)}." if failed else "all are within their tolerances."),
             "Of each kind of figure the one nearest to its limit is shown."]
    for (name, passed, _), checks in zip(tests, compared):
        lines += ["", f"## {name}" + ("" if passed else ": failed"), "", first_comment(name), ""]
        if checks:
            lines += ["| figure | compared | measured | expected | tolerance | of its limit |",
                      "|---|---|---|---|---|---|"]
        for what, check in sorted(checks.items()):
            lines.append(f"| {cell(what)} | {check.count} | " + " | ".join(check.cells)
                         + f" | {100 * check.share:.0f} % |")
    return lines


ROW = re.compile(r"^\| ([^|]+) \| `(\w+)`: ([^|]+?) \|.*$", flags=re.M)


def rounded(measured, expected, tolerance):
    """Returns the cells of a check, rounded to the second digit of the tolerance."""
    if not tolerance:
        return f"{float(measured):.2g}", expected
    room = float(tolerance.split()[-1])
    places = max(0, 1 - math.floor(math.log10(room))) if room > 0 else 0
    cells = [f"{round(float(each), places) + 0.0:.{places}f}" for each in (measured, expected)]
    return cells[0], f"{cells[1]} {tolerance}"


def fill_page(text, tests):
    """Returns the page's text with the figures in its rows."""
    checks = {name: read_checks(output) for name, _, output in tests}

    def fill(row):
        claim, name, figure = row.groups()
        if figure not in checks.get(name, {}):
            sys.exit(f"no test {name} compared '{figure}'")
        check = checks[name][figure]
        measured, expected = rounded(*check.cells)
        return f"| {claim} | `{name}`: {figure} | {check.count} | {measured} | {expected} |"

    return ROW.sub(fill, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", nargs="?", default="build", type=pathlib.Path, metavar="BUILD")
    parser.add_argument("--log", type=pathlib.Path, help="meson's log of tests that were run")
    parser.add_argument("--page", type=pathlib.Path, help="page whose tables get the figures")
    parser.add_argument("--check", type=pathlib.Path, help="page whose tables should have the figures")
    options = parser.parse_args()
    log = options.log
    if not log:
        subprocess.run(["meson", "test", "-C", options.build, "--suite", "physics", "--logbase",
                        "validation"], stdout=sys.stderr, check=False)
        log = options.build / "meson-logs" / "validation.json"
    if not log.is_file():
        sys.exit(f"{log}: there is no such log; build the tests first")
    tests = read_log(log)
    if not tests:
        sys.exit(f"{log}: has no physics tests")
    page = options.page or options.check
    if page:
        before = page.read_text(encoding="utf-8")
        after = fill_page(before, tests)
        if options.page:
            page.write_text(after, encoding="utf-8")
        elif before != after:
            sys.exit(f"{page}: not what the tests measured: report.py --page {page} writes it anew")
    else:
        print("\n".join(report(tests)))
    return 0 if all(passed for _, passed, _ in tests) else 1


if __name__ == "__main__":
    sys.exit(main())
