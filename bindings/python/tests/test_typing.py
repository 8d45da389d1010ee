"""Tests the package's types with mypy."""

import os
import pathlib
import subprocess

import pytest

from conftest import PACKAGE

TOP = pathlib.Path(__file__).resolve().parents[3]


def test_mypy_finds_nothing(tmp_path):
    reader = os.environ.get("SONJECT_READERS")
    if not reader:
        pytest.skip("SONJECT_READERS does not name a Python that has mypy")
    answer = subprocess.run([reader, "-m", "mypy", "--cache-dir", tmp_path, PACKAGE], cwd=TOP,
                            capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stdout + answer.stderr
