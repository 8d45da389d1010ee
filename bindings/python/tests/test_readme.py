"""The example of the README runs as it stands."""

import re

from conftest import PACKAGE_FOLDER


def test_the_example_runs(capsys):
    text = (PACKAGE_FOLDER / "README.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, flags=re.S)
    names = {}
    exec(compile(example, "README.md", "exec"), names)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "(128, 160) float32"
    assert len(lines) == 3
    truth = names["result"].objects[0]
    assert truth.is_visible
