"""Tests of options, help and the standard streams."""

import os
import pathlib
import re
import subprocess

import pytest

from conftest import COMMAND, assert_refused

SOURCE = pathlib.Path(__file__).resolve().parents[2]
VERBS = set(re.findall(r"^ +ROW\((\w+)\)", (SOURCE / "tools" / "verbs.h").read_text(), flags=re.M))


def test_version(sonject):
    answer = sonject("--version")
    assert answer.returncode == 0
    assert re.fullmatch(r"sonject \d+\.\d+\.\d+\n", answer.stdout)


def test_help_lists_the_verbs_that_exist(sonject):
    answer = sonject("--help")
    assert answer.returncode == 0
    listed = set(re.findall(r"^  sonject (\w+) ", answer.stdout, flags=re.M)) - {"help"}
    assert listed == VERBS
    assert sonject("help").stdout == sonject("-h").stdout == answer.stdout


@pytest.mark.parametrize("verb", sorted(VERBS))
def test_help_of_a_verb(sonject, verb):
    told = sonject.done("help", verb).stdout
    assert told.startswith(f"sonject {verb}")
    assert sonject(verb, "--help").stdout == told
    for option in re.findall(r"--[a-z-]+", told):
        assert_refused(sonject(verb, option + "x"), 2, "there is no option")


def test_help_of_a_key_is_its_row(sonject):
    answer = sonject("help", "sonar.altitude")
    assert answer.returncode == 0
    key, meaning, *facts = answer.stdout.splitlines()
    assert key == "sonar.altitude (required)"
    row = f"| `sonar.altitude` * | {meaning.strip()} |"
    assert row in (SOURCE / "tools/scenes/KEYS.md").read_text(encoding="utf-8")
    assert "    unit: m, km, cm, mm, from_file or first_return" in facts


def test_help_tells_keys_of_campaigns(sonject):
    reference = (SOURCE / "tools/campaigns/KEYS.md").read_text(encoding="utf-8")
    answer = sonject.done("help", "chip")
    listed = re.findall(r"^(\S+)", answer.stdout, flags=re.M)
    assert listed == re.findall(r"^\| `(chip[^`]*)`", reference, flags=re.M) and "chip.spread" in listed
    key, meaning, *facts = sonject.done("help", "targets[1].weight").stdout.splitlines()
    assert f"| `{key}` | {meaning.strip()} | number | 1 |" in reference and "    default: 1" in facts
    assert_refused(sonject("help", "chip.spraed"), 2, "did you mean chip.spread?")


def test_help_of_a_section_is_all_its_keys(sonject):
    reference = (SOURCE / "tools/scenes/KEYS.md").read_text(encoding="utf-8")
    for section in ("sonar", "elements."):  # elements is a verb, too
        answer = sonject("help", section)
        listed = re.findall(r"^(\S+)", answer.stdout, flags=re.M)
        name = section.rstrip(".")
        assert answer.returncode == 0
        assert set(re.findall(rf"^\| `({name}\.[^`]*)`", reference, flags=re.M)) <= set(listed)
    words = sonject("help", "objects[3].shape").stdout
    assert "words: plane, sphere," in words and words == sonject("help", "objects.shape").stdout


def test_help_of_a_word_is_every_key_that_ends_in_it(sonject):
    reference = [(SOURCE / "tools" / folder / "KEYS.md").read_text(encoding="utf-8")
                 for folder in ("scenes", "campaigns")]
    assert sonject.done("help", "altitude").stdout == sonject.done("help", "sonar.altitude").stdout
    for word in ("kind", "level.over_seabed", "draw", "spread"):
        rows = [key for text in reference for key in re.findall(r"^\| `([^`]*)`", text, flags=re.M)]
        wanted = [key for key in rows if f".{key}".endswith(f".{word}") or key.startswith((f"{word}.", f"{word}["))]
        assert re.findall(r"^(\S+)", sonject.done("help", word).stdout, flags=re.M) == wanted and wanted


def test_nothing_asked_is_a_usage_error(sonject):
    answer = sonject()
    assert answer.returncode == 2 and not answer.stdout and "sonject run" in answer.stderr


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["rnu"], ['no verb "rnu"', "did you mean run?"]),
        (["xylophone"], ["sonject --help"]),
        (["merge"], ["DIR is missing"]),
        (["run", "a.yaml", "-o", "d", "--shard", "5/4"], ["--shard", "5/4"]),
        (["run", "a.yaml", "-o", "d", "--shard", "0/4"], ["--shard", "0/4"]),
        (["run", "a.yaml", "-o", "d", "--shard", "2"], ["--shard", '"2"']),
        (["run", "a.yaml", "-o", "d", "--shard", "1/4x"], ["--shard", "1/4x"]),
        (["blend", "x"], ['no verb "blend"']),
        (["help", "rnu"], ["did you mean run?"]),
        (["help", "sonar.altitud"], ['key "sonar.altitud"', "did you mean sonar.altitude?"]),
        (["help", "altitdue"], ["did you mean altitude?"]),
        (["help", ""], ["sonject --help"]),
        (["help", "xylophone[0]"], ["sonject --help"]),
        (["run"], ["SCENE.yaml is missing"]),
        (["run", ""], ["must not be empty"]),
        (["run", "a.yaml"], ["-o DIR is missing"]),
        (["run", "a.yaml", "b.yaml", "-o", "d"], ["a.yaml", "b.yaml"]),
        (["run", "a.yaml", "-o"], ["needs a value"]),
        (["run", "a.yaml", "-o", "--quiet"], ["needs a value"]),
        (["run", "a.yaml", "-o", "d", "-o", "e"], ["given twice"]),
        (["run", "a.yaml", "-o", "d", "--sede", "1"], ["--sede", "did you mean --seed?"]),
        (["run", "a.yaml", "-o", "d", "--seed", "-1"], ["--seed", '"-1"']),
        (["run", "a.yaml", "-o", "d", "--seed", "1.5"], ["--seed", "whole number"]),
        (["run", "a.yaml", "-o", "d", "--seed", str(2**64)], ["--seed", str(2**64)]),
        (["run", "a.yaml", "-o", "d", "--seed="], ["--seed"]),
        (["run", "a.yaml", "-o", "d", "--quiet=yes"], ["takes no value"]),
        (["run", "a.yaml", "-o", "d", "-q"], ["-q"]),
        (["check", "a.yaml", "-o", "d"], ["-o"]),
        (["devices", "all"], ['"all"']),
        (["seabed"], ["-o IMAGE is missing"]),
        (["seabed", "-o", "x.tif", "--rows", "4294967297"], ["--rows"]),
        (["seabed", "-o", "x.tif", "--altitude", "10 kg"], ["--altitude", "unit 'kg' is not one of m, km"]),
        (["seabed", "-o", "x.tif", "--ripple-contrast", "1 m"], ["--ripple-contrast", "no unit"]),
        (["seabed", "-o", "x.tif", "--altitude", "nan"], ["--altitude", "nan"]),
        (["seabed", "-o", "x.tif", "--altitude", "0x10"], ["--altitude"]),
        (["seabed", "-o", "x.tif", "--altitude", "1e999"], ["--altitude"]),
        (["seabed", "-o", "x.tif", "--altitude", "1,5"], ["--altitude"]),
        (["seabed", "-o", "x.tif", "--altitude", ""], ["--altitude"]),
        (["measure"], ["IMAGE is missing"]),
        (["measure", "x.tif", "--box=1,1,4,4", "--targets", "y.png"], ["--targets"]),
        (["measure", "x.tif", "--transfer", "sqrt"], ["measure: --transfer", "sqrt"]),
        (["quicklook", "x.tif", "-o", "x.png", "--db", "0:-40"], ["--db", "MIN below MAX"]),
        (["quicklook", "x.tif", "-o", "x.png", "--db", "-40"], ["--db"]),
        (["convert", "x.tif", "x.png", "--db", "-6:-50"], ["convert: --db", "MIN below MAX"]),
        (["quicklook", "x.tif", "-o", "x.png", "--range-axis", "time"], ["slant or ground"]),
        (["quicklook", "x.tif", "-o", "x.png", "--first-range", "9"], ["--row-spacing"]),
        (["quicklook", "x.tif", "-o", "x.png", "--transfer", "sqrt"], ["sqrt"]),
        (["quicklook", "x.tif", "-o", "x.png", "--altitude", "0"], ["--altitude"]),
    ],
)
def test_wrong_usage_is_one_line(sonject, tmp_path, arguments, words):
    assert_refused(sonject(*arguments), 2, *words)
    assert not list(tmp_path.iterdir())


def test_numbers_take_units(sonject, tmp_path):
    for name, numbers in (("plain", (0.05, 9.5, 100e3, 30)), ("units", ("5 cm", "9500mm", "100 kHz", "30 deg"))):
        sonject.done("seabed", "-o", f"{name}.tif", "--rows=8", "--columns=8", "--ripple-contrast=0.5", *sum(zip(
            ("--row-spacing", "--altitude", "--frequency", "--ripple-heading"), numbers), ()))
    assert (tmp_path / "plain.tif").read_bytes() == (tmp_path / "units.tif").read_bytes()


def test_messages_stay_one_line_whatever_the_names(sonject):
    answer = sonject("check", "no\nsuch\x1b[31mfile.yaml")
    assert answer.returncode == 3
    assert len(answer.stderr.splitlines()) == 1
    assert "\x1b" not in answer.stderr


def test_check_prints_to_stdout(sonject, scene):
    answer = sonject.done("check", scene)
    assert not answer.stderr and "ball" in answer.stdout


@pytest.mark.parametrize("side", ["port", "starboard"])
def test_the_plan_of_check_lies_as_the_image(sonject, scene, side):
    """An object at row 12 of 96 is in the first eighths of the plan. Its shadow lies beyond it."""
    told = sonject.done("check", scene, "--set", f"input.geometry.side={side}", "--set",
                        "objects[0].position={row: 12, column: 20}").stdout
    plan = [line for line in told.splitlines() if line.startswith("  |")]
    marked = [row for row, line in enumerate(plan) if "#" in line]
    assert marked and marked[-1] < len(plan) // 3
    assert all("#:" in plan[row] for row in marked)


def test_a_full_standard_output_is_noticed(sonject, scene):
    with open("/dev/full", "w") as full:
        for arguments in (["--help"], ["--version"], ["check", scene], ["devices"]):
            answer = sonject(*arguments, stdout=full)
            assert answer.returncode == 5, arguments
            assert "standard output" in answer.stderr


def test_a_closed_standard_output_is_noticed(sonject, scene):
    answer = sonject("check", scene, preexec_fn=lambda: os.close(1))
    assert answer.returncode == 5
    assert "standard output" in answer.stderr


def test_a_run_needs_no_standard_streams(sonject, scene, tmp_path):
    def close_all():
        for descriptor in (0, 1, 2):
            os.close(descriptor)

    sonject.done("run", scene, "-o", "result", preexec_fn=close_all)
    for path in (tmp_path / "result").iterdir():
        assert b"sonject: " not in path.read_bytes()[:64]


def test_the_locale_does_not_change_numbers(tmp_path, sonject):
    for name in ("C", "de_DE.UTF-8", "nonsense"):
        sonject.done("seabed", "-o", f"{name}.tif", "--rows=8", "--columns=8", "--altitude=9.5",
                     changes={"LC_ALL": name})
    assert (tmp_path / "C.tif").read_bytes() == (tmp_path / "de_DE.UTF-8.tif").read_bytes()


def test_devices_are_a_table(sonject):
    answer = sonject("devices")
    assert answer.returncode == 0
    head, *rows = answer.stdout.splitlines()
    assert "name" in head and "platform" in head
    assert [row[0] for row in rows].count("*") == 1


def test_the_command_uses_only_the_public_interface():
    symbols = subprocess.run(
        ["nm", "-D", "--undefined-only", COMMAND], capture_output=True, text=True, check=True
    ).stdout
    used = set(re.findall(r"\bsonject_\w+", symbols))
    headers = SOURCE / "include" / "sonject"
    public = "".join(path.read_text() for path in headers.glob("*.h"))
    assert {"sonject_run", "sonject_check", "sonject_devices"} <= used
    assert used <= set(re.findall(r"\bsonject_\w+(?=\()", public))
