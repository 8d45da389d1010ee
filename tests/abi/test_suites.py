"""Tests that meson runs every test file of the command."""

import os
import pathlib
import re

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])


def test_every_file_of_the_commands_tests_is_run():
    written = (SOURCE / "tests" / "meson.build").read_text(encoding="utf-8")
    block = re.search(r"foreach name : \[(.*?)\]", written[written.index("# tests/cli/") :], re.S)
    named = re.findall(r"'(\w+)'", block.group(1))
    files = [path.stem.removeprefix("test_") for path in (SOURCE / "tests" / "cli").glob("test_*.py")]
    assert sorted(files) == sorted(named)
