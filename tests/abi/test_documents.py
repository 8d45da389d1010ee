"""What the documents name exists: functions, files, scenes."""
import os
import pathlib
import re
import shutil
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
FOLDERS = ("kernels", "lib", "include", "tools", "tests", "bindings")
PATH = rf"(?<![\w/.])(?:{'|'.join(FOLDERS)})/[\w./*-]+"
CODE = {".h", ".hpp", ".c", ".cpp", ".cl", ".py", ".build"}


def quoted(document):
    return set(re.findall(r"`([^`\n]+)`", (SOURCE / document).read_text(encoding="utf-8")))


def words_of_the_code():
    words = set()
    for folder in FOLDERS:
        for path in (SOURCE / folder).rglob("*"):
            if path.suffix in CODE:
                words |= set(re.findall(r"\w+", path.read_text(encoding="utf-8")))
    return words


def test_every_function_of_the_formulas_exists():
    names = {name for name in quoted("kernels/MATH.md") if re.fullmatch(r"[a-z]\w*", name)}
    assert len(names) > 100
    assert sorted(names - words_of_the_code()) == []


def test_every_file_that_documents_name_exists():
    missing = []
    for document in ("README.md", "CONTRIBUTING.md", "kernels/MATH.md",
                     "bindings/python/README.md"):
        for text in quoted(document):
            for name in re.findall(PATH, text):
                if not list(SOURCE.glob(name)):
                    missing.append(f"{document}: {name}")
    assert sorted(missing) == []


def test_the_reference_of_the_interface_is_made_without_warnings(tmp_path):
    if not shutil.which("doxygen"):
        pytest.skip("doxygen is not installed")
    settings = (SOURCE / "include" / "Doxyfile").read_text() + f"OUTPUT_DIRECTORY = {tmp_path}\n"
    answer = subprocess.run(["doxygen", "-"], input=settings, cwd=SOURCE, capture_output=True,
                            text=True, check=False)
    assert (answer.returncode, answer.stderr) == (0, "")
    folder = tmp_path / "html"
    head = (folder / "sonject_8hpp.html").read_text()
    assert "must not outlive the context" in head and "\n     sonject::scene scene(context);\n" in head
    pages = "".join(path.read_text() for path in folder.glob("*.html"))
    for name in (SOURCE / "tests" / "abi" / "symbols.txt").read_text().split():
        assert f"{name}()</h2>" in pages, name
    # what stands before a declaration and what stands behind one
    assert "Forgets" not in pages and "Puts the scene's objects into a patch" in pages
    assert "of the centre over the mean seabed" in pages
