"""Tests of a release: its version, CITATION.cff, and the sources by tools/release.sh. test_wheels.py tests
its wheels."""
import datetime
import hashlib
import os
import re
import shutil
import subprocess
import tarfile

import pytest
import yaml

from test_interface import SOURCE

VERSION = re.search(r"^  version: '(.*)',$", (SOURCE / "meson.build").read_text(), re.M).group(1)
SECTION = re.compile(r"^## (.*)$", re.M)


def test_sections_of_the_changelog_are_dated_unless_it_is_unreleased():
    first, *others = SECTION.findall((SOURCE / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert all(re.fullmatch(r"\d+\.\d+\.\d+ \(\d{4}-\d\d-\d\d\)", each) for each in others)
    assert first == "Unreleased" or first.startswith(f"{VERSION} (") and datetime.date.fromisoformat(first[-11:-1])


def test_the_citation_is_of_this_version():
    citation = yaml.safe_load((SOURCE / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0" and citation["type"] == "software"
    assert citation["title"] == "sonject" and citation["abstract"] and citation["message"]
    assert citation["authors"] == [{"name": "The sonject authors"}]
    assert citation["version"] == VERSION
    assert f"license: '{citation['license']}'" in (SOURCE / "meson.build").read_text()
    dates = re.findall(rf"^## {re.escape(VERSION)} \((.*)\)$", (SOURCE / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    assert [str(citation[key]) for key in ("date-released",) if key in citation] == dates


def test_pages_name_wheels_of_this_version():
    pages = [SOURCE / "README.md", SOURCE / "bindings" / "python" / "README.md"]
    named = [re.findall(r"sonject-([\d.]+)-py3-", page.read_text(encoding="utf-8")) for page in pages]
    assert named == [[VERSION], [VERSION]]


def make_clone(clone):
    """Makes a repository of the present files and tags it with this version. Its changelog has a section of
    this version. Returns a function that runs git in the repository."""
    variables = {**os.environ, "GIT_CONFIG_GLOBAL": os.devnull}
    for who in ("AUTHOR", "COMMITTER"):
        variables.update({f"GIT_{who}_NAME": "someone", f"GIT_{who}_EMAIL": "someone@example.org",
                          f"GIT_{who}_DATE": "2026-01-02T03:04:05Z"})
    listed = subprocess.run(["git", "ls-files"], cwd=SOURCE, check=True, capture_output=True, text=True).stdout
    for name in listed.splitlines():
        if (SOURCE / name).exists():
            (clone / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, clone / name)

    def run(*words):
        subprocess.run(["git", *words], cwd=clone, env=variables, check=True, capture_output=True)

    run.folder = clone
    run("init")
    set_section(clone, f"{VERSION} (2026-01-02)")
    run("add", "-A")
    run("commit", "-m", "All")
    run("tag", f"v{VERSION}")
    return run


@pytest.fixture
def git(tmp_path):
    return make_clone(tmp_path / "clone")


def set_section(clone, section):
    path = clone / "CHANGELOG.md"
    path.write_text(SECTION.sub(f"## {section}", path.read_text(encoding="utf-8"), count=1), encoding="utf-8")


def release(git, *words):
    return subprocess.run(["sh", git.folder / "tools" / "release.sh", *words], check=False, capture_output=True, text=True)


def assert_sums(folder):
    """Asserts that SHA256SUMS lists all other files of a release."""
    sums = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir() if path.name != "SHA256SUMS"}
    lines = (folder / "SHA256SUMS").read_text().splitlines()
    assert lines == [f"{sums[name]}  {name}" for name in sorted(sums)]


def assert_refused(answer, words):
    assert answer.returncode == 1 and words in answer.stderr and answer.stdout == "", answer.stderr


def test_the_sources_are_those_of_the_tag(git):
    answer = release(git, f"v{VERSION}", "none")
    assert answer.returncode == 0, answer.stderr
    folder = git.folder / "build-release" / f"sonject-{VERSION}"
    archive = folder / f"sonject-{VERSION}.tar.gz"
    assert answer.stdout.splitlines()[-1] == str(folder) and sorted(folder.iterdir()) == [folder / "SHA256SUMS", archive]
    assert_sums(folder)
    before = archive.read_bytes()
    with tarfile.open(archive) as opened:
        files = {member.name: member for member in opened.getmembers() if member.isfile()}
        text = opened.extractfile(f"sonject-{VERSION}/meson.build").read()
    assert text == (SOURCE / "meson.build").read_bytes()
    listed = subprocess.run(["git", "ls-files"], cwd=git.folder, check=True, capture_output=True, text=True).stdout
    assert set(files) == {f"sonject-{VERSION}/{name}" for name in listed.splitlines()}
    (git.folder / "later").touch()
    git("add", "later")
    git("commit", "-m", "Later")
    assert release(git, f"v{VERSION}", "none").returncode == 0
    assert archive.read_bytes() == before


def test_what_is_no_release_is_refused(git):
    assert_refused(release(git), "which tag?")
    assert_refused(release(git, "v9.9.9", "none"), "there is no tag v9.9.9")
    git("tag", "v9.9.9")
    assert_refused(release(git, "v9.9.9", "none"), f"meson.build says version {VERSION}: the tag must be v{VERSION}")
    (git.folder / "new").touch()
    assert_refused(release(git, f"v{VERSION}", "none"), "not committed")
    (git.folder / "new").unlink()
    for section in ("Unreleased", VERSION, f"{VERSION} (soon)"):
        set_section(git.folder, section)
        git("commit", "-a", "-m", "Take the date away")
        git("tag", "-f", f"v{VERSION}")
        assert_refused(release(git, f"v{VERSION}", "none"), f"no section '## {VERSION} (YYYY-MM-DD)'")
    assert not (git.folder / "build-release").exists()
