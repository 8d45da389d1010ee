"""Tests of the documents: functions, files and link targets that they name exist, and pages are readable."""
import os
import pathlib
import re
import runpy
import shutil
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["SONJECT_SOURCE"])
FOLDERS = ("kernels", "lib", "include", "tools", "tests", "bindings")
# All tracked pages. Pages that builds leave in other folders are not among them.
DOCUMENTS = sorted({"README.md", "CONTRIBUTING.md", "CHANGELOG.md",
                    *(str(path.relative_to(SOURCE)) for folder in (*FOLDERS, "docs")
                      for path in (SOURCE / folder).rglob("*.md"))})
READABILITY = SOURCE / ".ci" / "readability.py"
SPELLING = SOURCE / ".ci" / "spelling.py"
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
    for document in set(DOCUMENTS) - {"CHANGELOG.md"}:
        for text in quoted(document):
            for name in re.findall(PATH, text):
                if not list(SOURCE.glob(name)):
                    missing.append(f"{document}: {name}")
    assert sorted(missing) == []


def anchors(document):
    """Returns the anchors of a page's headings."""
    text = re.sub(r"^```.*?^```", "", (SOURCE / document).read_text(encoding="utf-8"), flags=re.S | re.M)
    headings = re.findall(r"^#+ (.*)$", text, flags=re.M)
    return {re.sub(r"[^\w -]", "", heading).strip().lower().replace(" ", "-") for heading in headings}


def test_every_link_leads_somewhere():
    broken, followed = [], 0
    for document in DOCUMENTS:
        text = (SOURCE / document).read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```|`[^`\n]*`", "", text, flags=re.S | re.M)):
            name, _, anchor = link.partition("#")
            place = (SOURCE / document).parent / name if name else SOURCE / document
            followed += 1
            if not place.exists() or anchor and anchor not in anchors(place):
                broken.append(f"{document}: {link}")
    assert broken == [] and followed > 20


def judge(*pages):
    return subprocess.run([sys.executable, READABILITY, *pages], check=False, capture_output=True, text=True)


def test_pages_can_be_read():
    answer = judge()
    assert answer.returncode == 0, answer.stdout
    assert "README.md: " in answer.stdout and "docs/physics.md: " in answer.stdout


def test_long_sentences_are_refused(tmp_path):
    short, long = "This is short.\n", "Word " * 29 + "end. "
    pages = {name: tmp_path / name for name in ("good.md", "tail.md", "median.md")}
    pages["good.md"].write_text(9 * short + long + "\n| " + 30 * "cell " + "|\n```\n" + 40 * "code " + "\n```\n")
    pages["tail.md"].write_text(8 * short + 2 * long)
    pages["median.md"].write_text("One two three four five six seven eight nine ten, and here are just six more. " * 6 + 5 * short)
    assert judge(pages["good.md"]).returncode == 0
    assert "90th percentile: 30, at most 28" in judge(pages["tail.md"]).stdout
    assert "median: 16, at most 15" in judge(pages["median.md"]).stdout and judge(pages["median.md"]).returncode == 1


def test_a_long_readme_is_refused():
    complaints = runpy.run_path(str(READABILITY))["complaints"]
    assert complaints("README.md", 100 * "Ten words a line are not too many for anyone.\n") == [
        "README.md: words: 1000, at most 900"]
    assert complaints("README.md", 101 * "Short.\n") == ["README.md: lines: 101, at most 100"]
    assert complaints("docs/physics.md", 101 * "Short.\n") == []


def test_no_word_is_misspelt(tmp_path):
    answer = subprocess.run([sys.executable, SPELLING], check=False, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    (tmp_path / "page.md").write_text("The colour is a color of frequncy.\n\n    widht code\n")
    (tmp_path / "code.c").write_text("/* The lenght of a cilinder. */\n")
    files = [tmp_path / "page.md", tmp_path / "code.c"]
    answer = subprocess.run([sys.executable, SPELLING, *files], check=False, capture_output=True, text=True)
    assert answer.returncode == 1
    assert sorted(re.findall(r": (\w+)(?: ==>|: not in)", answer.stdout)) == [
        "cilinder", "color", "frequncy", "frequncy", "lenght", "widht"]


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
    # doxygen keeps comments before a declaration and comments behind one
    assert "Forgets" not in pages and "Puts the scene's objects into a patch" in pages
    assert "of the centre over the mean seabed" in pages
