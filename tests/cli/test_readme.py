"""The commands of ours that the documents tell a reader to type are typed here, and fragments of
scene files are read. One that is new in a document fails until it can be run."""

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
from documents import (MARKDOWN, SOURCE, comment_commands, markdown_commands, read, spans,
                       suggested_settings)

BUILD = pathlib.Path(COMMAND).resolve().parent.parent
SCENES = sorted(f"tools/scenes/{path.name}" for path in (SOURCE / "tools" / "scenes").glob("*.yaml"))

# What takes the place of a command that stands for many, in the order in which they are run.
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
    "sonject calibrate SWATH -o FILE": "sonject calibrate swath.tif -o calibrated.yaml",
    "sonject quicklook IMAGE -o PNG": "sonject quicklook whole/image.tif -o look.png",
    "sonject convert IN OUT": "sonject convert swath.tif swath.npy",
    "sonject convert --range-axis slant":
        "sonject convert swath.tif ground.tif --range-axis ground --row-spacing 0.025 "
        "--column-spacing 0.025 --first-range 25 --altitude 10 && "
        "sonject convert ground.tif slant.tif --range-axis slant",
    "sonject seabed -o IMAGE": "sonject seabed -o seabed.tif",
    "sonject VERB --help": "sonject measure --help",
    "sonject help KEY": "sonject help sonar.frequency && sonject help sonar.",
    "SONJECT_MUTATIONS=100000 build/tests/unit/unit_scene_hostile":
        "SONJECT_MUTATIONS=500 build/tests/unit/unit_scene_hostile",
    "build/tests/unit/unit_scene_reference tools/scenes/KEYS.md":
        "build/tests/unit/unit_scene_reference KEYS.md && cmp KEYS.md tools/scenes/KEYS.md",
    "export PYTHONPATH=build/bindings/python SONJECT_LIBRARY=build/lib/libsonject.so.0":
        "export PYTHONPATH=build/bindings/python SONJECT_LIBRARY=build/lib/libsonject.so.0; "
        "python3 -c 'import sonject; print(sonject.version())'",
    "array=$(sbatch --parsable --array=1-4 tools/slurm/shards.sh 4 campaign campaign.yaml -o data)":
        "array=$(sbatch --parsable --array=1-4 tools/slurm/shards.sh 4 campaign campaign.yaml "
        "-o data); sbatch --dependency=afterany:$array tools/slurm/merge.sh data; "
        "cmp data/all/coco.json whole_set/all/coco.json",
}
# Commands of ours that other tests run: shapes in code, the campaign that is an example, and what
# hands shards out.
ELSEWHERE = re.compile(
    r"env/bin/|sonject run tools/scenes/user_shape\.yaml|sonject campaign tools/campaigns/|sonject fit |for i in 1 2 3; do "
    r"sonject seabed|parallel |condor_submit |dask |sbatch |python3 |scontrol |array=.* run ")


CAMPAIGN = """\
sonject_campaign: 1
scene: scene.yaml
images: 4
chip: {rows: 64, columns: 64}
splits: {all: 1}
swaths: [{path: swath.tif}]
targets: [{class: ball, object: {shape: sphere, diameter: 0.3 m}}]
"""

# Runs what Slurm's would put into its queue, at once.
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


def documented_commands():
    found = [text for name in MARKDOWN for text in markdown_commands(name)]
    found += [text for name in [*SCENES, "tools/campaigns/minefield.yaml"]
              for text in comment_commands(name)]
    return list(dict.fromkeys(found))


COMMANDS = documented_commands()
TO_TYPE = [text for text in TYPED if text in COMMANDS]
TO_TYPE += [text for text in COMMANDS
            if "sonject " in text and text not in TYPED and not ELSEWHERE.match(text)]


@pytest.fixture(scope="module")
def project(tmp_path_factory, environment):
    """A folder like the project's, with what the commands expect to find, and how to type there."""
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
    (folder / "mine.yaml").write_text(own_scene())
    return folder, type_in


def own_scene():
    """The scene of the README for a swath of one's own."""
    return re.search(r"```yaml\n(.*?)```", read("README.md"), flags=re.S)[1]


def test_the_scene_for_a_swath_of_ones_own_is_short_and_whole(project):
    folder, _ = project
    assert len(own_scene().splitlines()) <= 15
    answer = subprocess.run([COMMAND, "check", "mine.yaml"], cwd=folder, text=True,
                            capture_output=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert "cylinder (cylinder): row 200.0, slant range 37.4" in answer.stdout


def test_what_is_typed_instead_is_for_commands_that_are_there():
    assert sorted(set(TYPED) - set(COMMANDS)) == []


@pytest.mark.parametrize("command", TO_TYPE)
def test_commands_do_what_they_should(project, command):
    folder, type_in = project
    line = TYPED.get(command, command)
    # the examples with few rays
    type_in(line + " --set injection.rays=0.1" * ("run tools/scenes/" in line))
    if "--shard" not in line:  # all else leaves results alone
        assert not list(folder.glob("*/work"))


def test_every_example_scene_is_run():
    for name in SCENES:
        assert [text for text in comment_commands(name) if name in text], name


def test_every_option_exists():
    tables = "".join(path.read_text(encoding="utf-8") for path in (SOURCE / "tools").glob("*.[ch]"))
    known = set(re.findall(r'\{"(--[a-z-]+)"', tables)) | {"--help"}
    named = {option for name in ("README.md", "tools/slurm/README.md") for span in spans(name)
             if span.startswith("--") or span.startswith("sonject ")
             for option in re.findall(r"(?<!\S)--[a-z-]+", span)}
    assert len(named) > 10
    of_others = {"--array", "--cpus-per-task", "--mem", "--time", "--sshlogin", "--workdir"}
    assert sorted(named - known - of_others) == []


GEOMETRY = "input.geometry={row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 25 m}"
XTF = ["input={path: line.xtf, channel: port}"]
ROCK = f"objects=[{{shape: mesh, mesh: {{file: {SOURCE}/tools/targets/rock.obj, unit: cm}}}}]"
# Where a fragment of the README belongs: the key that it is the value of, "" where it tells that
# itself, and what else the scene needs before or behind it.
FRAGMENTS = {
    "input: {path: line.xtf, channel: port}": ("", [], [GEOMETRY]),
    "input: {path: line.mat, array: swath}": ("", [], [GEOMETRY]),
    "bands: {low: {sonar: {frequency: 100 kHz}, input: {channel: 0}}, high: ...}":
        ("", ["input.path=line.xtf"], ["band=low"]),
    "{speed: 2 m/s, ping_rate: 20 Hz}": ("input.geometry.row_spacing", [], []),
    "input.geometry: from_file": ("", XTF, []),
    "sonar.altitude: from_file": ("", [*XTF, "input.geometry=from_file"], []),
    "level: {over_seabed: 14 dB}": ("objects[0].", [], []),
    "{target_strength: -20 dB}": ("objects[0].level", [], []),
    "mesh: {file: rock.obj, unit: cm, up: y}": ("objects[0].", [ROCK], []),
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
    "seabed.sediment: medium sand": ("", [], []),
    "side: port": ("input.geometry.", [], []),
}
# A campaign's, and what ends where a value would begin.
OTHER_FRAGMENTS = {
    "labels: [yolo, voc]", "target:", "visible: {highlight: 1.2 dB, shadow: -2.3 dB}", "chip.spread: 1",
    "chip: {rows: all, columns: all}", "draw: {table: bodies.csv}", "{file: bodies.csv, weight: count}",
    "format: as_input", "contacts: 80", "quantiles: [0.1, 0.5, 0.9]", "shadow_along: [0.5 m, 0.9 m, 1.8 m]"}


def test_fragments_of_scene_files_are_read(project):
    import sonject

    folder, _ = project
    written = {span for span in spans("README.md") if re.match(r"[\w.]+:(?: |$)|\{", span)}
    assert written == set(FRAGMENTS) | OTHER_FRAGMENTS
    for source in ("tools/targets/rock.obj", "tests/unit/pulse.csv"):
        (folder / pathlib.Path(source).name).write_bytes((SOURCE / source).read_bytes())
    samples = numpy.arange(24, dtype="<u2").reshape(3, 8)
    (folder / "line.xtf").write_bytes(recordings.xtf_bytes(samples, samples))
    here = os.getcwd()
    os.chdir(folder)
    try:
        for fragment, (place, before, after) in FRAGMENTS.items():
            key, value = place, fragment.replace("...", "{}")
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
        sonject.Scene.read(SOURCE / scene, [text for text in settings if "path" not in text],
                           allows_user_shapes=True).close()
