"""Tests of tracing and image formation as separate stages: a run's files, and images of other responses."""

import json
import signal
import subprocess

import numpy
import pytest

import images
from conftest import COMMAND, assert_refused, files_below, make_swath, write_scene
from test_run import DEMO, contents, limit_file_size, stop_at_the_bar


# A rough and smooth object of two parts.
PARTS = """\
  - name: buoy
    material: {reflection: 0.5, lambert: 0.05}
    position: {along_track: 1.8 m, slant_range: 26.5 m}
    parts:
      - {shape: cylinder, length: 0.4 m, diameter: 0.1 m}
      - {shape: sphere, diameter: 0.2 m, at: {up: 0.2 m}}
"""


# The response is the sonar's, and not measured on the image's speckle.
NOMINAL = ["--set", "injection.match={response: nominal}"]


def command(sonject, *arguments, **options):
    answer = sonject(*arguments, "--quiet", **options)
    assert (answer.returncode, answer.stdout, answer.stderr) == (0, "", "")


@pytest.fixture(scope="module")
def traced(tmp_path_factory, environment):
    """Makes a folder with a scene, its impulses and its run."""
    folder = tmp_path_factory.mktemp("traced")
    write_scene(folder, make_swath())
    scene = folder / "scene.yaml"  # a sinc reaches farther than other responses
    scene.write_text(scene.read_text().replace("sonar:\n", "sonar:\n  response: rectangular\n"))
    for arguments in (["trace", "scene.yaml", "-o", "impulses.sums"], ["run", "scene.yaml", "-o", "run"]):
        subprocess.run([COMMAND, *arguments, "--quiet", *NOMINAL], cwd=folder, env=environment, check=True)
    return folder


def compare_with_run(sonject, folder, scene, *options):
    """Asserts that the stages leave the result of a run."""
    command(sonject, "run", scene, "-o", "run", *options)
    command(sonject, "trace", scene, "-o", "impulses.sums", *options)
    command(sonject, "form", "impulses.sums", "-o", "formed")
    assert contents(folder / "formed") == contents(folder / "run")


def compare_shards_with_run(sonject, folder, scene, *options):
    for shard in ("2/2", "1/2"):
        command(sonject, "run", scene, "-o", "shards", "--shard", shard, *options)
    command(sonject, "merge", "shards")
    assert contents(folder / "shards") == contents(folder / "run")
    facts = [json.loads((folder / name / "run.json").read_text()) for name in ("shards", "run")]
    for one in facts:
        del one["times_s"], one["peak_memory_bytes"]
        for entry in one["files"]:
            del entry["changed_ns"]
    assert facts[0] == facts[1]


def options_of(chosen):
    return [word for each in chosen for word in ("--set", each)]


@pytest.mark.parametrize("interactions, mode", [(1, "composite"), (2, "resynthesise")])
def test_the_stages_leave_what_a_run_leaves(sonject, scene, tmp_path, interactions, mode):
    scene.write_text(scene.read_text() + PARTS)
    options = options_of([f"injection.interactions={interactions}", f"injection.mode={mode}",
                          "injection.order_energies=true"])
    compare_with_run(sonject, tmp_path, scene, *options, "--seed", "5")
    assert len(list((tmp_path / "formed").glob("energy_order_*.tif"))) == interactions


@pytest.mark.parametrize("chosen", [
    ["sonar.kind=real", "sonar.array={length: 1.2 m, heading: 0.2 deg}"],
    ["sonar.aperture=10 deg", "injection.mode=resynthesise",
     "sonar.pulse={kind: chirp, window: hann}",
     "sonar.motion={sway: [{amplitude: 1 mm, wavelength: 2 m}], "
     "yaw: {advance: 50 cm, bias: 0.05 deg}}"],
    ["seabed.relief=[{mound: {height: 10 cm, radius: 40 cm}}]", "surface={depth: 20 m}",
     "injection.interactions=2", "injection.order_energies=true"],
    ["injection.estimator=brute_force", "injection.mode=resynthesise",
     "sonar.transducer=1 m", "injection.interactions=2", "injection.order_energies=true"],
    ["input.complex=true", "seabed.map=coherent", "injection.mode=resynthesise",
     "input.geometry.side=starboard", "injection.columns=paper"],
], ids=lambda chosen: chosen[0])
def test_the_stages_of_other_sonars_seas_and_images(sonject, scene, tmp_path, swath, chosen):
    if "input.complex=true" in chosen:
        pixels = numpy.stack([swath, swath[::-1]], axis=2)
        (tmp_path / "swath.tif").write_bytes(images.tiff_bytes(pixels))
    has_shards = "seabed.relief" in chosen[0] or "injection.columns=paper" in chosen
    if has_shards:
        scene.write_text(scene.read_text() + PARTS)
    compare_with_run(sonject, tmp_path, scene, *options_of(chosen))
    if has_shards:
        compare_shards_with_run(sonject, tmp_path, scene, *options_of(chosen))
    told = json.loads((tmp_path / "run" / "run.json").read_text())["options"]["columns"]
    assert told == ("paper" if "injection.columns=paper" in chosen else "focused")


def test_the_same_trace_is_the_same_file(sonject, traced):
    command(sonject, "trace", "scene.yaml", "-o", "again.sums", *NOMINAL, folder=traced)
    assert (traced / "impulses.sums").read_bytes() == (traced / "again.sums").read_bytes()
    command(sonject, "form", "again.sums", "-o", "same", folder=traced)
    assert contents(traced / "same") == contents(traced / "run")
    # inputs are the same, so the result counts as finished
    for again in (["form", "again.sums"], ["run", "scene.yaml", *NOMINAL]):
        assert "already" in sonject.done(*again, "-o", "same", folder=traced).stderr


def test_another_pulse_needs_no_new_trace(sonject, traced):
    other = ["--set", "sonar.pulse={kind: chirp, window: hann}"]
    command(sonject, "form", "impulses.sums", "-o", "formed chirp", *other, folder=traced)
    command(sonject, "run", "scene.yaml", "-o", "chirp", *other, *NOMINAL, folder=traced)
    formed, run = (images.read_tiff(traced / name / "energy.tif").astype(float)
                   for name in ("formed chirp", "chirp"))
    # margins follow the pulse, so the fan has other rays
    assert abs(formed.sum() / run.sum() - 1) < 0.02


def test_where_the_fine_grid_is_the_same_another_bandwidth_gives_a_runs_bits(sonject, traced):
    # both bandwidths have 4 bins and 27 glint bins a pixel, and 13 bins of margin
    other = ["--set", "sonar.bandwidth=29.9 kHz"]
    command(sonject, "form", "impulses.sums", "-o", "formed near", *other, folder=traced)
    command(sonject, "run", "scene.yaml", "-o", "near", *other, *NOMINAL, folder=traced)
    assert contents(traced / "formed near") == contents(traced / "near")
    assert contents(traced / "near")["patch.tif"] != contents(traced / "run")["patch.tif"]


def test_other_responses_give_a_runs_image_but_for_the_noise_of_rays(sonject, traced):
    options = options_of(["sonar.bandwidth=15 kHz", "sonar.response=hamming", "sonar.resolution=7 cm"])
    command(sonject, "form", "impulses.sums", "-o", "formed far", *options, folder=traced)
    for seed in ("1", "2"):
        command(sonject, "run", "scene.yaml", "-o", seed, *options, "--seed", seed, *NOMINAL,
                folder=traced)
    formed, first, second = (images.read_tiff(traced / name / "energy.tif").astype(float)
                             for name in ("formed far", "1", "2"))
    bright = first > 1e-3 * first.max()
    by_seed = numpy.median(abs(second[bright] / first[bright] - 1))
    by_stages = numpy.median(abs(formed[bright] / first[bright] - 1))
    # The traced grid is no coarser, so its rays differ no more than those of two seeds. The factor 1.5
    # leaves room for the spread of two medians over thousands of pixels. Bins of width d, an eighth of
    # the resolution, widen the squared pulse's variance v = 11.5 d^2 by d^2/6, the traced ones by a
    # quarter of that. The variances differ by 1.1 %, and energies at a distance t by (t^2/v - 1)/2 of
    # that: 1.3 % at the median of t among pixels above -30 dB.
    assert 0 < by_seed < 0.2 and by_stages < 1.5 * by_seed + 0.013
    assert abs(formed.sum() / first.sum() - 1) < 0.02


def test_shadows_that_keep_the_traced_aspects_are_noted(sonject, traced):
    for change, is_noted in (
        ("sonar.bandwidth=15 kHz", False),
        ("sonar.response=rectangular", False),
        ("sonar.response=hamming", True),
        ("sonar.resolution=7 cm", True),
    ):
        answer = sonject("form", "impulses.sums", "-o", "noted", "--overwrite", "--set", change, folder=traced)
        assert answer.returncode == 0
        assert ("shadows and rough highlights keep" in answer.stderr) == is_noted, change


def test_what_needs_a_new_trace_is_refused(sonject, traced):
    for change, *words in (
        ("sonar.bandwidth=31 kHz", "sonar.bandwidth", "31 kHz", "to 30 kHz", "trace again"),
        ("sonar.bandwidth=5 kHz", "sonar.bandwidth", "5 kHz", "trace again"),
        ("sonar.resolution=2 cm", "sonar.resolution", "2 cm", "2.5 cm", "trace again"),
        ("sonar.resolution=2 m", "sonar.resolution", "trace again"),
        ("injection.seed=4", "injection.seed", "needs a new trace"),
        ("sonar.responses=hamming", "sonar.responses", "needs a new trace"),
        ("sonar={}", "--set sonar:", "needs a new trace"),
        ("sonar.bandwidth=broad", "sonar.bandwidth", "broad"),
    ):
        answer = sonject("form", "impulses.sums", "-o", "result", "--set", change, folder=traced)
        assert_refused(answer, 3, *words)
        assert not files_below(traced / "result")


def test_names_of_files_are_meant_from_where_the_scene_was_traced(sonject, scene, tmp_path):
    folder = tmp_path / "scenes"
    folder.mkdir()
    scene.rename(folder / "scene.yaml")
    (tmp_path / "swath.tif").rename(folder / "swath.tif")
    command(sonject, "trace", "scenes/scene.yaml", "-o", "a.sums")
    command(sonject, "trace", "scenes/scene.yaml", "-o", "b.sums", "--set",
            "input.path=scenes/swath.tif")
    command(sonject, "form", "a.sums", "-o", "near")
    (tmp_path / "elsewhere").mkdir()
    for name in ("a.sums", "b.sums"):
        sonject.done("form", f"../{name}", "-o", f"result {name}", folder="elsewhere")
        assert contents(tmp_path / "elsewhere" / f"result {name}") == contents(tmp_path / "near")


def test_another_image_or_scene_is_refused(sonject, scene, tmp_path, swath):
    command(sonject, "trace", scene, "-o", "impulses.sums")
    command(sonject, "form", "impulses.sums", "-o", "first")
    moved = tmp_path / "moved.tif"
    (tmp_path / "swath.tif").rename(moved)
    assert_refused(sonject("form", "impulses.sums", "-o", "result"), 3, "swath.tif")
    command(sonject, "form", "impulses.sums", "-o", "result", "--set", "input.path=moved.tif")
    assert contents(tmp_path / "result") == contents(tmp_path / "first")
    swath[3, 4] *= 2
    moved.write_bytes(images.tiff_bytes(swath))
    answer = sonject("form", "impulses.sums", "-o", "other", "--set", "input.path=moved.tif")
    assert_refused(answer, 3, "moved.tif", "swath.tif", "XXH3")
    assert not files_below(tmp_path / "other")


def test_a_changed_target_file_is_refused(sonject, scene, tmp_path):
    target = tmp_path / "target.yaml"
    target.write_text("sonject_target: 1\nshape: sphere\ndiameter: 0.3 m\n")
    scene.write_text(scene.read_text().split("objects:")[0] +
                     "objects: [{target: target.yaml, position: centre}]\n")
    command(sonject, "trace", scene, "-o", "impulses.sums")
    target.write_text(target.read_text().replace("0.3", "0.4"))
    answer = sonject("form", "impulses.sums", "-o", "other")
    assert_refused(answer, 3, "not what was traced", "trace again")


def test_damaged_files_are_refused(sonject, traced, tmp_path):
    whole = (traced / "impulses.sums").read_bytes()
    changed = bytearray(whole)
    changed[len(whole) // 2] ^= 4
    # tests/unit/test_sums_file.c has more ways
    for name, content in {"cut": whole[: len(whole) // 2], "changed": bytes(changed),
                          "text": b"sonject: 1\n" * 100}.items():
        (tmp_path / "damaged.sums").write_bytes(content)
        answer = sonject("form", "damaged.sums", "-o", "result")
        assert_refused(answer, 3, "damaged.sums")
        assert not files_below(tmp_path / "result"), name
    command(sonject, "run", "scene.yaml", "-o", "half", "--shard", "1/2", folder=traced)
    (shard,) = (traced / "half" / "work").glob("*.sums")
    assert_refused(sonject("form", shard, "-o", "result"), 3, shard.name, "sonject merge")
    assert_refused(sonject("form", "none.sums", "-o", "result"), 3, "none.sums", "no such")
    assert_refused(sonject("form", tmp_path, "-o", "result"), 5, str(tmp_path))


def left_by_trace(folder):
    return {path.name for path in folder.iterdir()} - {"home", "scene.yaml", "swath.tif"}


def test_a_limit_on_file_sizes_leaves_no_trace(sonject, tmp_path):
    command(sonject, "trace", DEMO, "-o", "first.sums")  # fills the driver's cache too
    answer = sonject("trace", DEMO, "-o", "impulses.sums", preexec_fn=limit_file_size)
    assert_refused(answer, 5, "impulses.sums", "cannot write")
    assert left_by_trace(tmp_path) == {"first.sums"}
    assert_refused(sonject("trace", DEMO, "-o", "none/impulses.sums"), 5, "none/impulses.sums")


@pytest.mark.parametrize("number, code", [(signal.SIGTERM, 85), (signal.SIGKILL, -signal.SIGKILL)])
def test_a_trace_that_is_stopped_leaves_no_file(sonject, scene, tmp_path, environment, number, code):
    arguments = ["trace", scene, "-o", "impulses.sums", "--set", "injection.rays=512"]
    output = tmp_path / "impulses.sums"
    assert stop_at_the_bar(arguments, output, tmp_path, environment, number)[0] == code
    assert not (tmp_path / "impulses.sums").exists()
    if number == signal.SIGTERM:
        assert not left_by_trace(tmp_path)
