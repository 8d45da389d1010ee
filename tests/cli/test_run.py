"""Tests of whole runs: their files, and what happens when they are stopped."""

import json
import math
import os
import pathlib
import pty
import re
import resource
import shutil
import signal
import struct
import subprocess
import time

import numpy
import pytest

import images
from conftest import COLUMNS, COMMAND, ROWS, assert_refused, files_below, write_text

RESULTS = {
    "image.tif",
    "patch.tif",
    "energy.tif",
    "highlight.png",
    "shadow.png",
    "labels.png",
    "influence.png",
    "truth.json",
    "coco.json",
    "contacts.csv",
    "quicklook.png",
    "report.html",
    "run.json",
}
DEMO = pathlib.Path(os.environ["SONJECT_SOURCE"]) / "tools" / "scenes" / "demo.yaml"
# Enough rays for signals to arrive during tracing.
SLOW = ["--set", "injection.rays=512"]


def contents(folder):
    """Returns {name: bytes} of the results without run.json, which holds times."""
    return {
        path.name: path.read_bytes() for path in files_below(folder) if path.name != "run.json"
    }


def test_a_run_leaves_the_promised_files(sonject, scene, tmp_path, swath):
    assert not sonject.done("run", scene, "-o", "new/result").stdout
    folder = tmp_path / "new" / "result"
    assert {path.name for path in folder.iterdir()} == RESULTS
    for name in ("truth.json", "coco.json", "run.json"):
        json.loads((folder / name).read_text())
    for name in ("highlight.png", "shadow.png", "labels.png"):
        header = (folder / name).read_bytes()[16:26]
        colours = 3 if name == "labels.png" else 0
        assert struct.unpack(">IIBB", header) == (COLUMNS, ROWS, 8, colours)
    image = images.read_tiff(folder / "image.tif")
    assert image.dtype == numpy.float32 and image.shape == swath.shape
    same = image.view(numpy.uint32) == swath.view(numpy.uint32)
    assert same.any() and not same.all()
    assert files_below(tmp_path) == sorted(
        [scene, tmp_path / "swath.tif", *(folder / name for name in RESULTS)]
    )


def test_energies_of_orders_make_up_the_energy_and_do_not_stay(sonject, scene, tmp_path):
    folder = tmp_path / "result"
    for interactions in (1, 3):
        sonject.done("run", scene, "-o", "result", "--overwrite", "--set", "injection.order_energies=true",
                     "--set", f"injection.interactions={interactions}")
        names = [f"energy_order_{order}.tif" for order in range(1, interactions + 1)]
        assert {path.name for path in folder.iterdir()} == RESULTS | set(names)
        energies = [images.read_tiff(folder / name) for name in names]
        assert all(energy.dtype == numpy.float32 for energy in energies)
        assert all(energy.shape == (ROWS, COLUMNS) for energy in energies)
        total = images.read_tiff(folder / "energy.tif")
        # A pixel is the sum of some 200 energies in single precision, once for each order and once
        # for all orders. All energies are positive, so roundings add up to at most 200 x 2^-24.
        # Random roundings add up to about the square root of 200.
        assert numpy.allclose(sum(energies), total, rtol=64 * 2.0**-24, atol=0)
        options = json.loads((folder / "run.json").read_text())["options"]
        assert options["interactions"] == interactions and options["estimator"] == "connect"
    kept = (folder / "image.tif").read_bytes(), (folder / "energy.tif").read_bytes()
    sonject.done("run", scene, "-o", "result", "--overwrite", "--set", "injection.interactions=3")
    assert {path.name for path in folder.iterdir()} == RESULTS
    assert kept == ((folder / "image.tif").read_bytes(), (folder / "energy.tif").read_bytes())


OTHER_INPUTS = {
    "injection.seed (1 there, 2 here)": ["--seed", "2"],
    "objects[0]": ["--set", "objects[0].diameter=0.4 m"],
    "sonar": ["--set", "sonar.altitude=9 m"],
    "seabed.relief": ["--set", "seabed.relief=[{ripples: {wavelength: 40 cm, height: 3 cm}}]"],
    "input.geometry": ["--set", "input.geometry.row_spacing=2 cm"],
}


def test_a_result_of_other_inputs_is_refused_by_name(sonject, scene, tmp_path):
    sonject.done("run", scene, "-o", "result")
    before = {path: path.read_bytes() for path in files_below(tmp_path / "result")}
    for differs, changed in OTHER_INPUTS.items():
        answer = sonject("run", scene, "-o", "result", *changed)
        assert_refused(answer, 2, f"differs in {differs}", "--overwrite")
        assert before == {path: path.read_bytes() for path in files_below(tmp_path / "result")}
    everything = sum(OTHER_INPUTS.values(), [])
    sonject.done("run", scene, "-o", "result", *everything, "--overwrite")
    sonject.done("run", scene, "-o", "other", *everything)
    assert contents(tmp_path / "result") == contents(tmp_path / "other")


def test_a_swath_that_changed_beside_the_patch_is_refused_by_name(sonject, scene, tmp_path, swath):
    patch = ["--set", f"patch={{row: 0, column: 0, rows: 90, columns: {COLUMNS}}}"]
    sonject.done("run", scene, "-o", "result", *patch)
    (tmp_path / "moved.tif").write_bytes((tmp_path / "swath.tif").read_bytes())
    elsewhere = sonject.done("run", scene, "-o", "result", *patch, "--set", "input.path=moved.tif")
    assert "already" in elsewhere.stderr
    swath[-1, -1] += 1
    (tmp_path / "swath.tif").write_bytes(images.tiff_bytes(swath))
    assert_refused(sonject("run", scene, "-o", "result", *patch), 2, "differs in", "swath.tif")


@pytest.mark.parametrize("name", ["image.tif", "labels.png", "truth.json", "coco.json", "image.txt", "energy_order_3.tif"])
def test_a_file_of_something_else_is_refused_by_name(sonject, scene, tmp_path, name):
    (tmp_path / name).write_bytes(b"mine")
    before = {path: path.read_bytes() for path in files_below(tmp_path)}
    assert_refused(sonject("run", scene, "-o", "."), 2, f"holds the file {name}, but no run.json", "--overwrite")
    assert before == {path: path.read_bytes() for path in files_below(tmp_path)}
    sonject.done("run", scene, "-o", ".", "--overwrite")
    assert b"mine" not in [path.read_bytes() for path in tmp_path.glob("*.*")] and not (tmp_path / "work").exists()


def truncate(path):
    path.write_bytes(path.read_bytes()[:-1])


def alter(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def alter_unseen(path):
    """Alters the file, but keeps its size and time."""
    time_ns = path.stat().st_mtime_ns
    alter(path)
    os.utime(path, ns=(time_ns, time_ns))


def test_what_is_lost_of_a_finished_run_is_made_again_and_nothing_else(sonject, scene, tmp_path):
    folder = tmp_path / "result"
    sonject.done("run", scene, "-o", "result")
    before = contents(folder)
    for name, harm in {"image.tif": pathlib.Path.unlink, "labels.png": truncate, "truth.json": alter,
                       "coco.json": alter_unseen}.items():
        harm(folder / name)
        answer = sonject.done("run", scene, "-o", "result", "--verbose")
        assert "already" not in answer.stderr
        assert f"{name} is not as it was written" in answer.stderr
        assert contents(folder) == before
    (folder / "image.tif").touch()
    times = {path: path.stat().st_mtime_ns for path in files_below(folder)}
    assert "already" in sonject.done("run", scene, "-o", "result").stderr
    assert times == {path: path.stat().st_mtime_ns for path in files_below(folder)}


def test_overrides_say_what_the_file_may_say(sonject, scene, tmp_path):
    sonject.done("run", scene, "-o", "a", "--seed", "7", "--set", "objects[0].diameter=0.3 m")
    scene.write_text(scene.read_text().replace("0.5 m", "30 cm"))
    sonject.done("run", scene, "-o", "b", "--set=injection.seed=7")
    sonject.done("run", scene, "-o", "c")
    assert contents(tmp_path / "a") == contents(tmp_path / "b")
    assert contents(tmp_path / "a")["image.tif"] != contents(tmp_path / "c")["image.tif"]


def test_bands_go_to_folders_of_their_names(sonject, scene, tmp_path):
    bands = ["--set", "bands={low: {sonar: {frequency: 90 kHz}}, high: {}}"]
    sonject.done("run", scene, "-o", "both", *bands)
    sonject.done("run", scene, "-o", "low", "--set", "sonar.frequency=90 kHz")
    sonject.done("run", scene, "-o", "high", *bands, "--set", "band=high")
    assert sorted(path.name for path in (tmp_path / "both").iterdir()) == ["high", "low"]
    for name in ("high", "low"):
        assert contents(tmp_path / "both" / name) == contents(tmp_path / name)
    assert contents(tmp_path / "low")["image.tif"] != contents(tmp_path / "high")["image.tif"]
    assert "already" in sonject.done("run", scene, "-o", "both", *bands).stderr
    assert_refused(sonject("check", scene, *bands), 3, "bands", "choose one of low, high")


def test_a_sediment_is_the_lambert_that_it_tells(sonject, scene, tmp_path):
    """The model's handbook (table 3) has medium sand at 100 kHz: -29.8 dB at 10 deg, -24.2 dB at 20 deg."""
    sonject.done("run", scene, "-o", "sand", "--set", "seabed.sediment=medium sand", "--quiet")
    numbers = json.loads((tmp_path / "sand" / "truth.json").read_text())["numbers"]
    told = numbers["seabed_lambert_db"]["value"]
    assert numbers["seabed_sediment"] == {"grain_size_phi": 1.5, "model": "APL-UW TR 9407"}
    (ball,) = json.loads((tmp_path / "sand" / "truth.json").read_text())["objects"]
    grazing = math.radians(ball["grazing_deg"])
    assert 15 < ball["grazing_deg"] < 25
    assert told + 20 * math.log10(math.sin(grazing)) == pytest.approx(
        numpy.interp(ball["grazing_deg"], [10, 20, 40], [-29.8, -24.2, -21.7]), abs=0.7)
    sonject.done("run", scene, "-o", "number", "--set", f"seabed.lambert={told:.12f} dB", "--quiet")
    one, other = (images.read_tiff(tmp_path / name / "energy.tif") for name in ("sand", "number"))
    assert abs(one - other).max() < 1e-5 * one.max()
    answer = sonject("run", scene, "-o", "high", "--set", "seabed.sediment=silt", "--set", "sonar.frequency=300 kHz")
    assert "its model is valid from 10 to 100 kHz" in answer.stderr


def test_a_level_is_over_the_seabed_at_the_echos_range(sonject, scene, tmp_path):
    """Lambert's law is taken at the grazing angle of the seabed there, not at that of the ball's centre."""
    sonject.done("run", scene, "-o", "out", "--set", "seabed.lambert=-27 dB", "--quiet")
    (ball,) = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"]
    ranges = [ball["highlight"]["slant_range_m"] + part * ball["highlight"]["width_m"] for part in (0, 1)]
    nearest, farthest = (-27 + 20 * math.log10(10 / distance) for distance in ranges)
    assert nearest - farthest < 0.2
    assert farthest <= ball["level"]["seabed_strength_db"] <= nearest


def test_verbose_tells_what_happens_to_an_8_bit_swath(sonject, scene, tmp_path):
    swath = numpy.full((ROWS, COLUMNS), 100, numpy.uint8)
    swath[3, 4:7] = 255
    (tmp_path / "swath.png").write_bytes(images.png_bytes(swath))
    chosen = ["--set", "input.path=swath.png"]
    usual = sonject.done("run", scene, "-o", "usual", *chosen)
    floor, cut, note, result = usual.stderr.splitlines()
    assert floor.startswith("sonject: note: no shadow in the patch shows the noise floor, so 22.5 dB under")
    assert "the highlight of 'ball' is cut at the image's ceiling" in cut
    assert note.startswith("sonject: note: image.png is a new file")
    assert result == "sonject: the result is in usual"
    header = (tmp_path / "usual" / "image.png").read_bytes()[16:26]
    assert struct.unpack(">IIBB", header) == (COLUMNS, ROWS, 8, 0)
    answer = sonject.done("run", scene, "-o", "result", *chosen, "--verbose", "--device", "pthread")
    assert not answer.stdout
    *news, last = answer.stderr.splitlines()
    assert last == "sonject: the result is in result"
    assert all(line.startswith("sonject: ") for line in news)
    for words in ("device '", "trace_rough.cl built in", "shows the noise floor",
                  "3 pixels of the patch are at the image's full scale"):
        assert len([line for line in news if words in line]) == 1, (words, news)
    quiet = sonject.done("run", scene, "-o", "quiet", *chosen, "--verbose", "--quiet")
    assert (quiet.stdout, quiet.stderr) == ("", "")


def test_only_the_driver_keeps_programs_and_a_run_needs_no_home(sonject, scene, tmp_path, environment):
    drivers = {"POCL_CACHE_DIR": environment["XDG_CACHE_HOME"] + "/pocl/kcache"}
    empty = {"XDG_CACHE_HOME": str(tmp_path / "caches"), "HOME": str(tmp_path / "home")}
    gone = {"HOME": None, "XDG_CACHE_HOME": None}
    closed = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null/cache"}
    for name, changes in {"empty": empty, "gone": gone, "closed": closed}.items():
        sonject.done("run", scene, "-o", name, "--device", "pthread", changes={**changes, **drivers})
        assert contents(tmp_path / name) == contents(tmp_path / "empty")
    assert not files_below(tmp_path / "caches") + files_below(tmp_path / "home")


def test_an_unknown_device_is_named(sonject, scene, tmp_path):
    answer = sonject("run", scene, "-o", "result", "--device", "abacus")
    assert_refused(answer, 4, "abacus")
    assert not files_below(tmp_path / "result")


def limit_file_size():
    """Makes writing fail beyond 2 MiB of a file, as on a full disk. The driver's files of a program that it
    knows are smaller."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**21, 2**21))


def test_a_limit_on_file_sizes_leaves_nothing_half(sonject, scene, tmp_path):
    uniform = f"uniform: {{rows: 5000, columns: {COLUMNS}}}"  # 2.6 MB of pixels
    patch = f"patch: {{row: 2000, column: 0, rows: {ROWS}, columns: {COLUMNS}}}\n"
    scene.write_text(scene.read_text().replace("path: swath.tif", uniform) + patch)
    # The first run fills the driver's cache, which is not tested here.
    sonject.done("run", scene, "-o", "first")
    answer = sonject("run", scene, "-o", "result", preexec_fn=limit_file_size)
    assert_refused(answer, 5, "result")
    assert not (tmp_path / "result" / "run.json").exists()
    assert {path.name for path in files_below(tmp_path / "result")} <= RESULTS
    sonject.done("run", scene, "-o", "result")
    assert contents(tmp_path / "result") == contents(tmp_path / "first")


def start_at_a_terminal(arguments, folder, variables):
    mine, its = pty.openpty()
    process = subprocess.Popen(
        [COMMAND, *map(str, arguments)], cwd=folder, env=variables, stdout=its, stderr=its
    )
    os.close(its)
    return process, mine


def start_and_wait_for_the_bar(arguments, folder, variables):
    """Returns once the bar shows tracing. A bar of reading may come before, if the image takes long to
    read."""
    process, mine = start_at_a_terminal(arguments, folder, variables)
    seen = b""
    end = time.monotonic() + 120
    while not re.search(rb"tracing[^\r]*%", seen) and time.monotonic() < end:
        try:
            seen += os.read(mine, 4096)
        except OSError:  # the terminal was closed: the command ended
            break
    assert re.search(rb"tracing[^\r]*%", seen), seen
    return process, mine


def read_rest(terminal):
    rest = b""
    while True:
        try:
            more = os.read(terminal, 4096)
        except OSError:
            more = b""
        if not more:
            os.close(terminal)
            return rest.decode()
        rest += more


def stop_at_the_bar(arguments, output, folder, variables, *numbers):
    """Sends signals to the command once its bar is drawn. Returns its exit code and the text after that.
    This process may have to wait for the machine. If the command is done before a signal, its output is
    removed and it starts again."""
    for _ in range(5):
        process, terminal = start_and_wait_for_the_bar(arguments, folder, variables)
        for number in numbers:
            process.send_signal(number)
            time.sleep(0.02)
        text = read_rest(terminal)
        code = process.wait()
        if code != 0:
            break
        if output.is_dir():
            shutil.rmtree(output)
        else:
            output.unlink()
    return code, text


@pytest.fixture
def cold(tmp_path, environment):
    """Returns an environment in which the driver's cache is empty."""
    return {**environment, "XDG_CACHE_HOME": str(tmp_path), "POCL_CACHE_DIR": str(tmp_path / "pocl")}


def test_who_waits_for_the_drivers_compiler_reads_so_and_that_it_is_once(scene, tmp_path, cold):
    for is_first in (True, False):
        process, terminal = start_at_a_terminal(
            ["run", scene, "-o", f"first {is_first}", "--device", "pthread"], tmp_path, cold)
        text = read_rest(terminal)
        assert process.wait() == 0, text
        assert bool(re.search(r"\rcompiling, once: \d+ s .*%", text)) == is_first, text


def test_a_signal_while_the_driver_compiles_stops_a_run(scene, tmp_path, cold):
    process = subprocess.Popen([COMMAND, "run", scene, "-o", "result", "--device", "pthread"], cwd=tmp_path, env=cold,
                               text=True, stderr=subprocess.PIPE)
    while process.poll() is None and not (tmp_path / "pocl").exists():
        time.sleep(0.01)
    time.sleep(0.3)
    process.send_signal(signal.SIGTERM)
    said = process.communicate()[1]
    assert process.returncode == 85, said
    assert said.endswith("sonject: stopped; run the same command again\n")


@pytest.mark.parametrize(
    "number, code, words",
    [
        (signal.SIGTERM, 85, "sonject: stopped; run the same command again"),
        (signal.SIGINT, 130, "sonject: interrupted"),
    ],
)
def test_signals_stop_a_run(scene, tmp_path, environment, number, code, words):
    arguments = ["run", scene, "-o", "result", *SLOW]
    # schedulers send SIGTERM to all processes, and the script hands it on, too
    numbers = [number] * (2 if number == signal.SIGTERM else 1)
    result = tmp_path / "result"
    answer, text = stop_at_the_bar(arguments, result, tmp_path, environment, *numbers)
    assert answer == code, text
    assert words in text
    assert not (tmp_path / "result" / "run.json").exists()
    (kept,) = files_below(tmp_path / "result")  # the rays that were traced
    assert kept.parent.name == "work" and kept.suffix == ".sums"


@pytest.mark.parametrize("attempt", range(3))
def test_signals_that_follow_each_other_at_once_stop_a_run(scene, tmp_path, environment, attempt):
    """Also with OpenCL's libraries in the process, which the search for a GPU loads."""
    variables = {name: value for name, value in environment.items() if name != "SONJECT_DEVICE"}
    process = subprocess.Popen([COMMAND, "run", scene, "-o", "result", "--checkpoint", "1e-9", *SLOW], cwd=tmp_path, env=variables,
                               text=True, stderr=subprocess.PIPE)
    while process.poll() is None and not files_below(tmp_path / "result"):
        time.sleep(0.01)
    for _ in range(1000):
        process.send_signal(signal.SIGTERM)
    said = process.communicate()[1]
    assert process.returncode == 85, said
    assert said.endswith("sonject: stopped; run the same command again\n")


def test_seabed_and_quicklook_belong_together(sonject, tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        made = sonject.done("seabed", "-o", f"{name}.tif", "--rows=16", "--columns=20", "--seed", seed)
        assert not made.stderr
    a, b, c = (images.read_tiff(tmp_path / f"{name}.tif") for name in "abc")
    assert a.shape == (16, 20) and numpy.array_equal(a, b) and not numpy.array_equal(a, c)
    sonject.done("seabed", "-o", "pairs.tif", "--rows=16", "--columns=16", "--complex")
    assert images.read_tiff(tmp_path / "pairs.tif").shape == (16, 16, 2)
    for options in ([], ["--db", "-40:0"], ["--range-axis", "ground"]):
        assert not sonject.done("quicklook", "a.tif", "-o", "bed.png", *options).stderr
        assert (tmp_path / "bed.png").read_bytes().startswith(b"\x89PNG")
    assert len(list(tmp_path.iterdir())) == 5


def test_ground_range_is_drawn_of_what_tells_its_slant_range(sonject, tmp_path):
    numpy.save(tmp_path / "plain.npy", numpy.full((8, 9), 0.1, "f4"))
    sonject.done("seabed", "-o", "slant.tif", "--rows=16", "--columns=20")
    sonject.done("convert", "slant.tif", "ground.tif", "--range-axis=ground")
    for name, what in (("ground.tif", "already"), ("plain.npy", "where its columns lie")):
        asked = ["--range-axis=ground", "--altitude=5"]
        assert_refused(sonject("quicklook", name, "-o", "look.png", *asked), 3, name, what)
        assert not (tmp_path / "look.png").exists()
    sonject.done("convert", "ground.tif", "bare.npy")
    for name in ("ground.tif", "bare.npy"):
        sonject.done("quicklook", name, "-o", f"{name}.png")
    # the same pixels, once with axes in metres
    assert (tmp_path / "ground.tif.png").read_bytes() != (tmp_path / "bare.npy.png").read_bytes()


def test_a_geometry_that_is_not_the_files_is_told(sonject, tmp_path):
    sonject.done("seabed", "-o", "swath.tif", "--rows=64", "--columns=96", "--row-spacing=5cm", "--column-spacing=5cm", "--first-range=20m")
    write_text(tmp_path, "path: swath.tif", "row_spacing: 5.1 cm, column_spacing: 5 cm, first_slant_range: 20 m",
               "{shape: sphere, diameter: 40 cm}", "8 m")
    for changed, what in (("=from_file", None), (".row_spacing=5.1 cm", None),
                          (".row_spacing=10 cm", "rows of 0.05 m, not 0.1"),
                          ("={row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 30 m}", "from 20 m on, not 30"),
                          ("={row_spacing: 1 m, column_spacing: 1 cm, first_slant_range: 20 m}",
                           "rows of 0.05 m, not 1, columns of 0.05 m, not 0.01")):
        setting = ["--set", "input.geometry" + changed]
        for told in (sonject.done("check", "scene.yaml", *setting).stdout,
                     sonject.done("run", "scene.yaml", "-o", "out", "--overwrite", *setting).stderr):
            assert ("swath.tif tells other spacings" in told) == (what is not None)
            # only what differs is told
            assert what is None or f"swath.tif tells other spacings and ranges than the scene: {what};" in told
