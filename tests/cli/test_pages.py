"""Runs what README and pages tell a reader to type: commands, scenes, fragments of scene files, programs
in Python, and mistakes for their messages. New text in a page fails until it can be run. C and C++ are
in tests/abi/test_installed.py, MATLAB's language is in test_matlab.py."""

import json
import os
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import images
import recordings
from conftest import COMMAND, SCENE
from documents import (MARKDOWN, PAGES, SOURCE, blocks, comment_commands, markdown_commands, read, spans,
                       suggested_settings, table_cells)

BUILD = pathlib.Path(COMMAND).resolve().parent.parent
GALLERY = "docs/gallery.md"
SCENES = sorted(f"tools/scenes/{path.name}" for path in (SOURCE / "tools" / "scenes").glob("*.yaml"))

# Documented commands with placeholders, and the commands that are run instead, in this order.
TYPED = {
    "sonject run SCENE.yaml -o DIR": "sonject run scene.yaml -o whole",
    "sonject run SCENE.yaml -o DIR --shard I/K":
        "for i in 1 2; do sonject run scene.yaml -o parts --shard $i/2; done",
    "sonject merge DIR": "sonject merge parts && cmp parts/image.tif whole/image.tif",
    "sonject trace SCENE.yaml -o FILE": "sonject trace scene.yaml -o impulses.sums",
    "sonject form FILE -o DIR":
        "sonject form impulses.sums -o formed && cmp formed/image.tif whole/image.tif",
    "sonject campaign CAMPAIGN.yaml -o DIR": "sonject campaign campaign.yaml -o whole_set",
    "sonject elements SCENE.yaml -o DIR":
        "sonject elements scene.yaml -o series --set injection.mode=resynthesise",
    "sonject check SCENE.yaml": "sonject check scene.yaml",
    "sonject measure IMAGE": "sonject measure swath.tif",
    "sonject calibrate SWATH": "sonject calibrate swath.tif --picture calibrated.png",
    "sonject quicklook IMAGE -o PNG": "sonject quicklook whole/image.tif -o look.png",
    "sonject convert IN OUT": "sonject convert swath.tif swath.npy",
    "sonject convert --range-axis slant":
        "sonject convert swath.tif told.tif --range-axis ground --row-spacing 0.025 "
        "--column-spacing 0.025 --first-range 25 --altitude 10 && "
        "sonject convert told.tif untold.tif --range-axis slant",
    "sonject seabed -o IMAGE": "sonject seabed -o seabed.tif",
    "sonject VERB --help": "sonject measure --help",
    "sonject help KEY": "sonject help sonar.frequency && sonject help sonar.",
    "SONJECT_MUTATIONS=100000 build/tests/unit/unit_scene_hostile":
        "SONJECT_MUTATIONS=500 build/tests/unit/unit_scene_hostile",
    "build/tests/unit/unit_scene_reference tools/scenes/KEYS.md tools/campaigns/KEYS.md":
        "build/tests/unit/unit_scene_reference KEYS.md CAMPAIGNS.md && cmp KEYS.md tools/scenes/KEYS.md && "
        "cmp CAMPAIGNS.md tools/campaigns/KEYS.md",
    "export PATH=$PWD/build/tools:$PATH PYTHONPATH=$PWD/build/bindings/python":
        "export PATH=$PWD/build/tools:$PATH PYTHONPATH=$PWD/build/bindings/python; "
        "unset SONJECT_LIBRARY; cd /; "
        "sonject help sonar.frequency && python3 -c 'import sonject; print(sonject.version())'",
    "export PYTHONPATH=$PWD/build/bindings/python":
        "export PYTHONPATH=$PWD/build/bindings/python; unset SONJECT_LIBRARY; cd /; "
        "python3 -c 'import sonject; print(sonject.version())'",
    "array=$(sbatch --parsable --array=1-4 tools/slurm/shards.sh 4 campaign campaign.yaml -o data)":
        "array=$(sbatch --parsable --array=1-4 tools/slurm/shards.sh 4 campaign campaign.yaml "
        "-o data); sbatch --dependency=afterany:$array tools/slurm/merge.sh data; "
        "cmp data/all/coco.json whole_set/all/coco.json",
}
# Commands that are run elsewhere: the file that runs them, and a word of that file.
ELSEWHERE = {
    r"sh tools/first-run\.sh|meson setup build &&": ("tests/abi/test_package.py", "first-run.sh"),
    r"env/bin/pip install \.$": ("tests/abi/test_package.py", "mesonpy.build_wheel"),
    r"sh tools/test\.sh": (".ci/run", "tools/test.sh"),
    r"sh tools/wheels\.sh|(env/bin/)?pip install .*\.whl|python3 -m venv env$|env/bin/sonject ":
        ("tests/abi/test_wheels.py", "wheels.sh"),
    r"meson install |cc program\.c": ("tests/abi/test_installed.py", "pkg-config"),
    r"man ": ("tests/abi/test_installed.py", "man1"),
    r"doxygen ": ("tests/abi/test_documents.py", "Doxyfile"),
    r"meson test -C build --benchmark": ("tests/benchmark/meson.build", "benchmark("),
    r"python3 docs/gallery\.py ": ("tests/cli/test_pages.py", "test_the_gallery_shows"),
    r"python3 tests/physics/report\.py": (".ci/run", "tests/physics/report.py"),
    r"PYTHONPATH=\.\.\. ": ("tests/meson.build", "'bindings' / 'python' / 'tests'"),
    r"for i in 1 2 3; do sonject seabed|sonject campaign tools/campaigns/": ("tests/cli/test_campaign.py", "minefield.yaml"),
    r"sonject init |sonject run line\.yaml|sonject quicklook line\.xtf|sonject (check|campaign) line_campaign": ("tests/cli/test_init.py", "first_detector.md"),
    r"python3 bindings/python/examples/train_detector": ("bindings/python/tests/test_train_detector.py", "train_detector"),
    r"sonject fit ": ("tests/cli/test_fit.py", '"fit"'),
    r"parallel |sbatch |scontrol |array=.* run |RequeueExit": ("tests/cli/test_job_scripts.py", "documented("),
    # these are not run, as the README says
    r"condor_submit |dask |python3 tools/slurm/dask": ("tools/slurm/README.md", "It does not run those for HTCondor and Dask"),
}


CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: 4
chip: {rows: 64, columns: 64}
splits: {all: 1}
swaths: [{path: swath.tif}]
targets: [{class: ball, object: {shape: sphere, diameter: 0.3 m}}]
"""

# Replaces Slurm's sbatch and runs at once what that would queue.
SBATCH = """\
#!/bin/bash
tasks=
while [[ $1 == --* ]]; do
    [[ $1 == --array=* ]] && tasks=$(eval "echo {${1#--array=}}" | sed 's/-/../; s/^/echo /')
    shift
done
for task in $(eval "${tasks:-echo 0}"); do
    SLURM_ARRAY_TASK_ID=$task sh "$@" >&2 || exit 1
done
echo 7
"""


def typed_by(pages):
    return [text for name in pages for text in markdown_commands(name)]


OF_SCENES = [text for name in [*SCENES, "tools/campaigns/minefield.yaml"] for text in comment_commands(name)]
COMMANDS = list(dict.fromkeys([*typed_by(MARKDOWN), *OF_SCENES]))


def elsewhere(command):
    return next((place for pattern, place in ELSEWHERE.items() if re.match(pattern, command)), None)


TO_TYPE = [text for text in TYPED if text in COMMANDS]
TO_TYPE += [text for text in dict.fromkeys([*typed_by(PAGES), *OF_SCENES])
            if "sonject " in text and text not in TYPED and not elsewhere(text)]


@pytest.fixture(scope="module")
def project(tmp_path_factory, environment):
    """Makes a folder like the project's with all files that commands expect. Returns it and a runner of lines."""
    folder = tmp_path_factory.mktemp("project")
    programs = folder / "programs"
    programs.mkdir()
    for name in ("tools", "bindings"):
        (folder / name).symlink_to(SOURCE / name)
    (folder / "build").symlink_to(BUILD)
    (programs / "sonject").symlink_to(COMMAND)
    (programs / "sbatch").write_text(SBATCH)
    (programs / "sbatch").chmod(0o755)
    (programs / "python3").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    (programs / "python3").chmod(0o755)
    swath = numpy.random.default_rng(1).rayleigh(0.07, (96, 128)).astype(numpy.float32)
    (folder / "swath.tif").write_bytes(images.tiff_bytes(swath))
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "campaign.yaml").write_text(CAMPAIGN)
    variables = {**environment, "PATH": f"{programs}:{environment['PATH']}",
                 "PYTHONPATH": str(BUILD / "bindings" / "python")}

    def type_in(line):
        answer = subprocess.run(["bash", "-euc", line], cwd=folder, env=variables, text=True,
                                capture_output=True, timeout=600, check=False)
        assert answer.returncode == 0, answer.stdout + answer.stderr

    type_in("sonject seabed -o image.png --rows 472 --columns 512 --first-range 43.6125")
    type_in("sonject seabed -o my_swath.tif --rows 400 --columns 500 --row-spacing 0.05 "
            "--first-range 30")
    (folder / "ground.tif").write_bytes(images.tiff_bytes(swath))
    (folder / "mine.yaml").write_text(own_scene())
    for number in (1, 2, 3):
        (folder / f"swath_{number}.tif").write_bytes(images.tiff_bytes(swath * number))
    type_in("sonject convert my_swath.tif patch.npy")
    both = numpy.hstack([swath] * 8)
    (folder / "both_sides.tif").write_bytes(images.tiff_bytes(both))
    samples = numpy.rint(1000 * swath).astype("<u2")
    for name in ("line.xtf", "line_2.xtf"):
        (folder / name).write_bytes(recordings.xtf_bytes(samples, samples))
    (folder / "my_mine.stl").write_text(stl_of_a_box(300, 1200, 300))
    for source in ("tools/targets/rock.obj", "tests/unit/pulse.csv"):
        (folder / pathlib.Path(source).name).write_bytes((SOURCE / source).read_bytes())
    return folder, type_in


def stl_of_a_box(width, length, height):
    """Returns an STL file, in text, of twelve triangles. The sides are along x, y and z."""
    corners = [(x, y, z) for x in (0, width) for y in (0, length) for z in (0, height)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [each for a, b, c, d in faces for each in ((a, b, c), (a, c, d))]
    lines = [f"facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corners[i]) for i in each) +
             "endloop\nendfacet\n" for each in triangles]
    return "solid mine\n" + "".join(lines) + "endsolid mine\n"


def own_scene():
    """Returns the README's scene for a swath of the user's own."""
    return blocks("README.md", "yaml")[0]


def test_the_scene_for_a_swath_of_ones_own_is_short_and_whole(project):
    folder, _ = project
    assert len(own_scene().splitlines()) <= 15
    answer = subprocess.run([COMMAND, "check", "mine.yaml"], cwd=folder, text=True,
                            capture_output=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert "cylinder (cylinder): row 200.0, slant range 37.4" in answer.stdout


def test_every_command_is_run_here_or_where_the_table_says():
    for page in PAGES:
        for command in markdown_commands(page):
            assert command in TYPED or command in TO_TYPE or elsewhere(command), f"{page}: {command}"
    for name, word in ELSEWHERE.values():
        assert word in read(name), name
    assert [pattern for pattern in ELSEWHERE if not any(re.match(pattern, each) for each in COMMANDS)] == []


def test_what_is_typed_instead_is_for_commands_that_are_there():
    assert sorted(set(TYPED) - set(COMMANDS)) == []


@pytest.mark.parametrize("command", TO_TYPE)
def test_commands_do_what_they_should(project, command):
    folder, type_in = project
    line = TYPED.get(command, command)
    # the examples run with few rays
    type_in(line + " --set injection.rays=0.1" * ("run tools/scenes/" in line))
    if "--shard" not in line:  # other commands leave no work folder
        assert not list(folder.glob("*/work"))


def test_every_example_scene_is_run():
    assert SCENES and TO_TYPE and YAML and any(suggested_settings(name) for name in SCENES)
    for name in SCENES:
        assert [text for text in comment_commands(name) if name in text], name


def test_every_option_exists():
    tables = "".join(path.read_text(encoding="utf-8") for path in (SOURCE / "tools").glob("*.[ch]"))
    known = set(re.findall(r'[{ ]"(--[a-z-]+)",', tables)) | {"--help"}
    named = {option for name in PAGES for span in spans(name)
             if span.startswith("--") or span.startswith("sonject ")
             for option in re.findall(r"(?<!\S)--[a-z-]+", span)}
    assert len(named) > 10
    of_others = {"--page", "--array", "--cpus-per-task", "--mem", "--time", "--sshlogin", "--workdir"}
    assert sorted(named - known - of_others) == []


LANGUAGES = {"sh", "yaml", "python", "c", "cpp", "cmake", "matlab"}


def test_blocks_of_code_are_in_languages_that_tests_run():
    for page in PAGES:
        fences = re.findall(r"^```(.*)$", read(page), flags=re.M)
        assert set(fences[::2]) <= LANGUAGES and set(fences[1::2]) <= {""}, page
        if page != "docs/embedding.md":
            assert not any(blocks(page, each) for each in ("c", "cpp", "cmake", "matlab")), page


# docs/gallery.py runs the gallery's Python, whose blocks build on each other.
@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python") and page != GALLERY])
def test_python_runs(project, page, monkeypatch):
    folder, _ = project
    monkeypatch.chdir(folder)
    for block in blocks(page, "python"):
        exec(compile(block, page, "exec"), {})


def with_sections(scene, block):
    """Returns the scene, with its sections replaced by those of the block."""
    sections = re.findall(r"^\w+:.*\n(?: .*\n)*", scene, flags=re.M)
    new = re.findall(r"^(\w+):", block, flags=re.M)
    return "".join(each for each in sections if each.split(":")[0] not in new) + block


YAML = [(page, number) for page in PAGES for number in range(len(blocks(page, "yaml")))]


@pytest.mark.parametrize("page, number", YAML)
def test_scenes_and_sections_of_them_are_taken(project, page, number):
    folder, type_in = project
    block = blocks(page, "yaml")[number]
    (folder / "block.yaml").write_text(block)
    if block.startswith("sonject_campaign:"):
        type_in(f"sonject campaign block.yaml -o block{number} --set images=6")
    elif block.startswith("quantiles:"):  # quantiles are read before the device is looked for
        answer = subprocess.run([COMMAND, "fit", "campaign.yaml", "block.yaml", "-o", "fitted.yaml", "--device", "none"],
                                cwd=folder, text=True, capture_output=True, check=False)
        assert answer.returncode == 4, answer.stderr
    else:
        type_in("sonject calibrate my_swath.tif -o calibrated.yaml")
        (folder / "block.yaml").write_text(with_sections(SCENE, block))
        band = " --set band=low" * ("bands:" in block) + " --set input.path=line.xtf" * ("channel: 1" in block)
        type_in("sonject check block.yaml" + band)


# The messages that docs/messages.md explains, and commands with the mistakes that cause them.
MISTAKES = {
    "unknown key; did you mean ...": "sonject check scene.yaml --set sonar.altitud=3",
    "missing; add it ...": "sonject check scene.yaml --set 'sonar={frequency: 100 kHz, bandwidth: 30 kHz}'",
    "unit ... is not one of ...": "sonject check scene.yaml --set 'sonar.frequency=100 km'",
    "lies outside the patch ...": "sonject check scene.yaml --set 'objects[0].position={row: 500, column: 3}'",
    "is in ground range ...": "sonject convert my_swath.tif stated.tif --range-axis ground --altitude 10 && "
                              "sonject check scene.yaml --set input.path=stated.tif",
    "is of no format that sonject knows ...": "sonject check scene.yaml --set input.path=campaign.yaml",
    "there is no such scene file ...": "sonject check none.yaml",
    "holds another result ...": "sonject run scene.yaml -o mistake && sonject run scene.yaml -o mistake --seed 2",
    "cannot be seen ...": "sonject run scene.yaml -o drowned --set 'objects[0]={shape: sphere, diameter: 10 cm, "
                                "burial: 9 cm, level: {target_strength: -120 dB}}' && false",
    "no device has ...": "sonject run scene.yaml -o nowhere --device none",
    "of ... shards, these are missing: ...": "sonject run scene.yaml -o part --shard 1/2 && sonject merge part",
}


def test_every_message_that_is_explained_has_its_mistake():
    assert table_cells("docs/messages.md", "message") == list(MISTAKES)


@pytest.mark.parametrize("message", MISTAKES)
def test_mistakes_have_the_messages_that_are_explained(project, message):
    _, type_in = project
    with pytest.raises(AssertionError) as failure:
        type_in(MISTAKES[message])
    expected = ".*".join(re.escape(part) for part in re.split(r" ?\.\.\. ?", message))
    assert re.search(expected, str(failure.value)), str(failure.value)


def test_all_keys_of_truth_are_explained(project):
    folder, type_in = project
    type_in("sonject run scene.yaml -o explained")
    truth = json.loads((folder / "explained" / "truth.json").read_text())
    keys = list(truth)
    for key, value in truth["objects"][0].items():
        is_section = key in ("pose", "dimensions", "level")
        keys += [f"{key}.{part}" for part in value] if is_section else [key]
    rows = re.findall(r"^\| (`.*?) \|", read("docs/truth.md"), flags=re.M)
    told = [span for row in rows for span in re.findall(r"`([^`]+)`", row)]
    assert sorted(told) == sorted(keys)


def test_exit_codes_are_those_of_the_command():
    codes = re.findall(r"EXIT_CODE_\w+ = (\d+)", read("tools/console.h"))
    assert table_cells("docs/messages.md", "exit code") == codes


def test_the_picture_of_the_demo_is_what_the_command_makes(tmp_path):
    from PIL import Image

    subprocess.run([sys.executable, SOURCE / "docs" / "demo.py", COMMAND, tmp_path / "demo.png"], check=True)
    made, kept = (Image.open(path).convert("RGB") for path in (tmp_path / "demo.png", SOURCE / "docs" / "demo.png"))
    assert made.tobytes() == kept.tobytes() and (SOURCE / "docs" / "demo.png").stat().st_size < 200_000


def test_the_gallery_shows_what_its_page_makes(tmp_path):
    """Images have the same bits everywhere. The last bit of NumPy's logarithm could change a grey level only at the
    border between two levels, and no pixel is that close to one."""
    from PIL import Image

    subprocess.run([sys.executable, SOURCE / "docs" / "gallery.py", tmp_path], check=True)
    kept = sorted((SOURCE / "docs" / "gallery").iterdir())
    assert [path.name for path in kept] == sorted(path.name for path in tmp_path.iterdir())
    assert sorted(re.findall(r"\(gallery/(.*?)\)", read(GALLERY))) == [path.name for path in kept]
    assert sum(path.stat().st_size for path in kept) < 1_500_000

    def pixels(path):
        picture = Image.open(path).convert("RGB")
        return picture.size, picture.tobytes()

    assert [path.name for path in kept if pixels(path) != pixels(tmp_path / path.name)] == []


ROCK = f"objects=[{{shape: mesh, mesh: {{file: {SOURCE}/tools/targets/rock.obj, unit: cm}}}}]"
# The place of each fragment: the key whose value it is, or a prefix ("" or ending in a dot) if the
# fragment names its key. Then the settings that the scene needs before and after it.
FRAGMENTS = {
    "{speed: 2 m/s, ping_rate: 20 Hz}": ("input.geometry.row_spacing", [], []),
    "{kind: amplitude}": ("input.transfer", [], []),
    "injection.match.looks: 2": ("", [], []),
    "{kind: intensity}": ("input.transfer", [], []),
    "{kind: decibel, parameter: 0.5, offset: -90 dB}": ("input.transfer", [], []),
    "{kind: gamma, parameter: 2}": ("input.transfer", [], []),
    "{kind: schlick, parameter: 20}": ("input.transfer", [], []),
    "calibration: auto": ("input.", [], []),
    "array: swath": ("input.", [], []),
    "nadir_column: 399": ("input.geometry.", [], []),
    "injection.noise_floor: -18 dB": ("", [], []),
    "noise_floor: -25 dB": ("injection.", [], []),
    "injection.noise_floor_over: -20 dB": ("", [], []),
    "seabed.relief: [{scour: {width: 50 cm, depth: 5 cm}}]": ("", [], []),
    "{over_seabed: 14 dB}": ("objects[0].level", [], []),
    "smooth: 40 deg": ("objects[0].mesh.", [ROCK], []),
    "open: true": ("objects[0].mesh.", [ROCK], []),
    "injection.accuracy: 2 %": ("", [], []),
    "order_energies: true": ("injection.", [], []),
    "estimator: brute_force": ("injection.", ["injection.mode=resynthesise", "sonar.transducer=5 cm"],
                               []),
    "sonar.pulse: {kind: chirp, window: hann}": ("", [], []),
    "{kind: table, file: pulse.csv}": ("sonar.pulse", [], []),
    "sonar.kind: real": ("", ["sonar.array={length: 1 m}"], []),
    "aperture: none": ("sonar.", [], []),
}
# Fragments of campaigns, those that need a calibration, and those that end before their value.
OTHER_FRAGMENTS = {
    "labels: [yolo]", "target:", "visible: {highlight: 1.2 dB, shadow: -2.3 dB}", "chip.spread: 1",
    "chip: {rows: all, columns: all}", "draw: {table: bodies.csv}", "{file: bodies.csv, weight: count}", "{of: length, uniform: [0.5, 1]}",
    "format: as_input", "altitude: first_return", "grey: [-50 dB, -6 dB]", "clutter.labelled: false",
    "mesh.unit: {log_uniform: [0.2 cm, 1.3 cm]}"}


def test_fragments_of_scene_files_are_read(project):
    import sonject

    folder, _ = project
    written = {span for page in PAGES for span in spans(page) if re.match(r"[\w.]+:(?: |$)|\{", span)}
    assert written == set(FRAGMENTS) | OTHER_FRAGMENTS
    here = os.getcwd()
    os.chdir(folder)
    try:
        for fragment, (place, before, after) in FRAGMENTS.items():
            key, value = place, fragment
            if not fragment.startswith("{"):
                name, value = value.split(": ", 1)
                key = place + name
            overrides = [*before, f"{key}={value}", *after]
            try:
                sonject.Scene.read("scene.yaml", overrides).close()
            except sonject.SonjectError as error:
                pytest.fail(f"{fragment}: {error}")
    finally:
        os.chdir(here)


@pytest.mark.parametrize("scene", SCENES)
def test_settings_that_scenes_propose_are_taken(scene):
    import sonject

    settings = suggested_settings(scene)
    if settings:
        sonject.Scene.read(SOURCE / scene, [text for text in settings if "path" not in text]).close()
