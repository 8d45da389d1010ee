"""Tests that the validation report repeats the results of the physics tests."""
import json
import os
import pathlib
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
OUTPUT = """\
device: some CPU
[ RUN      ] test_ranges
2.5 m behind: level: 0.99, expected 1 +- 0.02
at 30 m: level: 1.015, expected 1 +- 0.02
level: 1.001, expected 1 +- 0.02
scatter: 0.5, to be below 2
exact: 0, expected 0 +- 0
[       OK ] test_ranges
"""


def make_report(tmp_path, *results):
    log = tmp_path / "testlog.json"
    entries = [{"name": "sonject:unit / text", "result": "OK", "stdout": "level: 9, to be below 1"}]
    entries += [{"name": f"sonject:physics / {name}", "result": result, "stdout": OUTPUT}
                for name, result in results]
    log.write_text("".join(json.dumps(entry) + "\n" for entry in entries))
    return subprocess.run([sys.executable, SOURCE / "tests" / "physics" / "report.py", "--log", log],
                          capture_output=True, text=True, check=False)


def test_the_figure_nearest_to_its_limit_is_shown(tmp_path):
    answer = make_report(tmp_path, ("seabed", "OK"))
    assert answer.returncode == 0, answer.stderr
    lines = answer.stdout.splitlines()
    assert "1 programs compared 5 figures with what is expected of them; all are within their " \
           "tolerances." in lines
    assert "## seabed" in lines and any("A plain Lambert seabed" in line for line in lines)
    assert "| level | 3 | 1.015 | 1 | ± 0.02 | 75 % |" in lines
    assert "| scatter | 1 | 0.5 | below 2 |  | 25 % |" in lines
    assert "| exact | 1 | 0 | 0 | ± 0 | 0 % |" in lines


def test_failures_are_told(tmp_path):
    answer = make_report(tmp_path, ("glints", "FAIL"), ("mirrors", "OK"))
    assert answer.returncode == 1
    assert "failed: glints." in answer.stdout and "## glints: failed" in answer.stdout
    assert make_report(tmp_path).returncode != 0


def test_a_page_gets_the_figures_that_it_names(tmp_path):
    make_report(tmp_path, ("seabed", "OK"))
    page = tmp_path / "page.md"

    def call(option):
        return subprocess.run([sys.executable, SOURCE / "tests" / "physics" / "report.py", "--log",
                               tmp_path / "testlog.json", option, page], capture_output=True, text=True, check=False)

    page.write_text("| All is well | `seabed`: level | |\n| `a`: b | c |\n| Little scatter | `seabed`: scatter | 9 | 9 | 9 |\n")
    assert call("--check").returncode == 1 and "9 | 9 | 9" in page.read_text()
    assert call("--page").returncode == 0 and call("--check").returncode == 0
    assert page.read_text() == ("| All is well | `seabed`: level | 3 | 1.015 | 1.000 ± 0.02 |\n| `a`: b | c |\n"
                                "| Little scatter | `seabed`: scatter | 1 | 0.5 | below 2 |\n")
    page.write_text("| A claim | `seabed`: nothing | |\n")
    assert "no test seabed compared 'nothing'" in call("--page").stderr
