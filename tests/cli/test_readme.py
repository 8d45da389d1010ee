"""The commands of the README do what it says."""

import os
import pathlib
import re
import shlex

import pytest

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
README = (SOURCE / "README.md").read_text(encoding="utf-8")
# Commands on a line of their own, or within the text, that name a scene which is there.
COMMANDS = sorted(set(re.findall(r"(?:build/tools/)?(sonject (?:run|check) tools/[^`\n]+)", README)))


@pytest.fixture
def project(tmp_path):
    """The working folder with the project's scenes and targets, and a swath."""
    (tmp_path / "tools").mkdir()
    for folder in ("scenes", "targets"):
        (tmp_path / "tools" / folder).symlink_to(SOURCE / "tools" / folder)
    return tmp_path


def test_the_readme_has_commands():
    assert len(COMMANDS) >= 2


@pytest.mark.parametrize("command", COMMANDS)
def test_scenes_of_the_readme_are_good(sonject, project, command):
    words = shlex.split(command)[1:]
    if "input.path=swath.png" in words:
        seabed = sonject("seabed", "-o", "swath.png", "--rows", "800", "--columns", "900")
        assert seabed.returncode == 0, seabed.stderr
    if "-o" in words:  # what check does not take
        del words[words.index("-o") : words.index("-o") + 2]
    answer = sonject("check", *words[1:])
    assert answer.returncode == 0, answer.stderr
