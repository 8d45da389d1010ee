"""The fixtures of the command's tests, but with the user's environment and compiled programs."""

import importlib.util
import os
import pathlib
import sys

import pytest

CLI = pathlib.Path(__file__).parents[1] / "cli"
sys.path.insert(0, str(CLI))
specification = importlib.util.spec_from_file_location("command_fixtures", CLI / "conftest.py")
command_fixtures = importlib.util.module_from_spec(specification)
sys.modules["command_fixtures"] = command_fixtures
specification.loader.exec_module(command_fixtures)

scene = command_fixtures.scene
sonject = command_fixtures.sonject
swath = command_fixtures.swath


@pytest.fixture(scope="session")
def environment():
    return dict(os.environ)
