"""Tests of injection into arrays."""

import copy
import ctypes
import gc
import math
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import sonject
from conftest import COLUMNS, GEOMETRY, ROWS
from sonject import _library
from sonject._values import library_pixels


SMALL = {"uniform": {"rows": 60, "columns": 90}, "geometry": GEOMETRY}


@pytest.fixture(params=["float32", "complex64"])
def patch(request, amplitude_patch, complex_patch):
    return amplitude_patch if request.param == "float32" else complex_patch


def test_layers_have_their_types(patch, make_scene):
    result = sonject.inject(patch, make_scene())
    types = {
        "image": patch.dtype,
        "field": numpy.complex64,
        "energy": numpy.float32,
        "visibility": numpy.float32,
        "highlight": numpy.uint8,
        "shadow": numpy.uint8,
        "labels": numpy.uint8,
        "influence": numpy.uint8,
    }
    for name, kind in types.items():
        layer = getattr(result, name)
        assert layer.shape == result.shape == (ROWS, COLUMNS), name
        assert layer.dtype == kind, name
        assert layer is getattr(result, name), name


@pytest.mark.parametrize("duplicate", [pickle.dumps, copy.copy, copy.deepcopy])
def test_a_result_that_is_pickled_says_what_to_take(patch, make_scene, duplicate):
    result = sonject.inject(patch, make_scene())
    with pytest.raises(TypeError, match="cannot be pickled or copied: take its arrays, such as result.image"):
        duplicate(result)


def test_empty_rows_stay_and_move_no_levels(patch, make_scene):
    beside = patch.copy()
    beside[: ROWS // 2 - 4] = 0
    scene = make_scene(injection={"noise_floor": "-20 dB"})
    whole, part = sonject.inject(patch, scene), sonject.inject(beside, scene)
    seen = (part.highlight | part.shadow) > 0
    assert seen.any() and not part.image[beside == 0].any() and not seen[: ROWS // 2 - 4].any()
    levels = [10 * numpy.log10((numpy.abs(result.image[part.shadow > 0]) ** 2).mean()) for result in (whole, part)]
    assert levels[0] == pytest.approx(levels[1], abs=0.4)


def test_the_sphere_shows_and_the_rest_keeps_its_bits(patch, make_scene):
    before = patch.copy()
    result = sonject.inject(patch, make_scene())
    assert numpy.array_equal(patch, before)
    untouched = result.influence == 0
    assert 0 < numpy.count_nonzero(~untouched) < untouched.size
    assert result.image[untouched].tobytes() == patch[untouched].tobytes()
    assert not numpy.array_equal(result.image, patch)
    assert result.highlight[ROWS // 2 - 12 : ROWS // 2 + 12].any()
    assert set(numpy.unique(result.labels)) == {0, 1}
    assert set(numpy.unique(result.highlight)) <= {0, 255}
    assert numpy.all((result.visibility >= 0) & (result.visibility <= 1))


def test_the_centre_of_parts_is_that_of_the_body(make_scene):
    """A box that a part puts elsewhere is where the same box is as a shape."""
    box = {"shape": "box", "length": 0.6, "width": 0.4, "height": 0.3}
    place = {"heading": "90 deg", "position": {"row": 20, "column": 30}}
    apart = {"parts": [{**box, "at": {"along": 0.2, "up": 0.5}}], **place}
    halves = {"parts": [{**box, "length": 0.3, "at": {"along": side, "up": 0.5}} for side in (0.05, 0.35)], **place}
    alone = sonject.inject(None, make_scene(input=SMALL, objects=[{**box, **place}])).objects[0]
    for parts in (apart, halves):
        (truth,) = sonject.inject(None, make_scene(input=SMALL, objects=[parts])).objects
        assert truth.height_m == pytest.approx(alone.height_m) == pytest.approx(0.15)
        assert truth.along_track_m == pytest.approx(alone.along_track_m)
        assert truth.ground_range_m == pytest.approx(alone.ground_range_m + 0.2)
        assert truth.overall_length_m == pytest.approx(0.6)


def test_another_object_leaves_an_echos_level_by_way_of_the_seabed(make_scene):
    """A box with its level 12 dB down lies 3 m from a cylinder as it is. A seventh is the cylinder's gain."""
    box = {"shape": "box", "length": 1.2, "width": 0.6, "height": 0.8, "heading": "15 deg",
           "position": {"row": 40, "column": 60}, "level": {"over_seabed": "14 dB"}}
    cylinder = {"shape": "cylinder", "length": 1, "diameter": 0.4, "heading": "20 deg", "position": {"row": 100, "column": 60}}
    wide = {"uniform": {"rows": 140, "columns": 180},
            "geometry": {"row_spacing": 0.05, "column_spacing": 0.05, "first_slant_range": 30}}
    sonar = {"frequency": 100e3, "bandwidth": 15e3, "altitude": 10}

    def second_order(*objects):
        scene = make_scene(input=wide, sonar=sonar, objects=list(objects), injection={"interactions": 2, "order_energies": True})
        return float(sonject.inject(None, scene).order_energies[1][10:70].sum())

    beside, alone = second_order(cylinder, box), second_order(box)
    print(beside / alone, second_order(cylinder) / alone)
    assert beside == pytest.approx(alone, rel=0.3)


def test_truth_and_statistics(patch, make_scene):
    result = sonject.inject(patch, make_scene())
    (truth,) = result.objects
    assert truth.is_visible
    assert truth.row == pytest.approx((ROWS - 1) / 2, abs=1)
    # The centre is nearer to the sonar than the ground point below it, which is the patch's middle.
    assert 0 < truth.column < COLUMNS / 2 + 1
    assert truth.height_m == pytest.approx(0.25)
    assert math.isfinite(truth.target_strength_db)
    rows, columns = truth.highlight.slices
    assert numpy.count_nonzero(result.highlight) == truth.highlight_pixels
    assert numpy.count_nonzero(result.highlight[rows, columns]) == truth.highlight_pixels
    assert result.statistics.rays > 0
    assert result.statistics.changed_pixels == numpy.count_nonzero(result.influence)
    assert math.isnan(result.statistics.correlation)


def test_orders_are_kept_only_where_asked_for(patch, make_scene):
    assert sonject.inject(patch, make_scene()).order_energies == []
    injection = {"interactions": 2, "order_energies": True}
    result = sonject.inject(patch, make_scene(injection=injection))
    for energy in result.order_energies:
        assert energy.dtype == numpy.float32 and energy.shape == (ROWS, COLUMNS)
    # pixels are formed of some 200 positive energies in single precision, each order by itself
    assert numpy.allclose(sum(result.order_energies), result.energy, rtol=64 * 2.0**-24, atol=0)


def test_orders_that_are_not_there_are_refused(amplitude_patch, make_scene):
    asked = make_scene(injection={"order_energies": True})
    result = sonject.inject(amplitude_patch, asked)
    energy = numpy.empty((ROWS, COLUMNS), numpy.float32)

    def copy(result, order, size=energy.nbytes):
        result.context.call(
            "sonject_result_order_energy", result, order, energy.ctypes.data, size
        )

    copy(result, 1)
    for order in (0, 2, 2**32 - 1):
        with pytest.raises(sonject.SonjectError, match=f"no order {order}, only 1 to 1") as caught:
            copy(result, order)
        assert caught.value.status is sonject.Status.ERROR_ARGUMENT
    with pytest.raises(sonject.SonjectError, match=f"has {energy.nbytes} bytes, the buffer 4"):
        copy(result, 1, 4)
    with pytest.raises(sonject.SonjectError, match="set order_energies"):
        copy(sonject.inject(amplitude_patch, make_scene()), 1)


def test_the_same_input_gives_the_same_bits(patch, make_scene):
    first = sonject.inject(patch, make_scene())
    second = sonject.inject(patch, make_scene())
    other = sonject.inject(patch, make_scene(injection={"seed": 2}))
    for name in ("image", "field", "energy", "labels"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes(), name
    assert first.image.tobytes() != other.image.tobytes()


def test_rows_with_any_stride_are_read_where_they_lie(patch, make_scene):
    wide = numpy.full((2 * ROWS, COLUMNS + 3), numpy.nan, patch.dtype)
    window = wide[::2, 1 : COLUMNS + 1]
    window[...] = patch
    pixels, array = library_pixels(window)
    assert array is window
    assert pixels.data == window.ctypes.data
    assert pixels.row_stride == 2 * wide.strides[0]
    expected = sonject.inject(patch, make_scene()).image
    assert sonject.inject(window, make_scene()).image.tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    "arrange",
    [
        lambda patch: numpy.asfortranarray(patch),
        lambda patch: patch[::-1][::-1][:, :],
        lambda patch: patch[::-1].copy()[::-1],
        lambda patch: patch[:, ::-1].copy()[:, ::-1],
        lambda patch: patch.astype(patch.dtype.newbyteorder()),
        lambda patch: patch.astype(numpy.result_type(patch.dtype, numpy.float64)),
    ],
    ids=["fortran", "twice", "rows reversed", "columns reversed", "byte order", "double"],
)
def test_other_arrangements_give_the_same(patch, make_scene, arrange):
    arranged = arrange(patch)
    assert numpy.array_equal(arranged, patch)
    expected = sonject.inject(patch, make_scene()).image
    assert sonject.inject(arranged, make_scene()).image.tobytes() == expected.tobytes()


def test_a_repeated_row_is_not_taken_for_packed_rows():
    row = numpy.arange(4, dtype=numpy.float32)
    repeated = numpy.broadcast_to(row, (3, 4))
    pixels, array = library_pixels(repeated)
    assert pixels.row_stride == 16
    assert numpy.array_equal(array, repeated)


@pytest.mark.parametrize(
    "patch, error, message",
    [
        (numpy.ones((4, 4), numpy.uint8), TypeError, "uint8 is refused"),
        (numpy.ones((4, 4), bool), TypeError, "bool is refused"),
        (numpy.ones((4, 4), object), TypeError, "object is refused"),
        (numpy.ma.masked_less(numpy.ones((4, 4), numpy.float32), 2), TypeError, "masked"),
        ("swath.png", TypeError, "read its pixels first"),
        (numpy.ones(4, numpy.float32), ValueError, "rows and columns"),
        (numpy.ones((4, 0), numpy.float32), ValueError, "rows and columns"),
        (numpy.full((4, 4), 1e300), ValueError, "beyond single precision"),
        (numpy.full((ROWS, COLUMNS), numpy.nan), sonject.SonjectError, "(?i)nan"),
    ],
)
def test_arrays_that_are_no_patch_are_refused(make_scene, patch, error, message):
    with pytest.raises(error, match=message):
        sonject.inject(patch, make_scene())


def test_no_patch_is_an_error(make_scene):
    with pytest.raises(sonject.SonjectError) as caught:
        sonject.inject(None, make_scene())
    assert caught.value.status is sonject.Status.ERROR_ARGUMENT


def test_a_uniform_input_needs_no_patch(make_scene):
    scene = make_scene()
    scene["input.uniform"] = {"rows": ROWS, "columns": COLUMNS}
    result = sonject.inject(None, scene)
    assert result.image.shape == (ROWS, COLUMNS)


def test_progress_rises_and_names_its_stages(amplitude_patch, make_scene):
    calls = []
    sonject.inject(
        amplitude_patch, make_scene(), progress=lambda fraction, stage: calls.append((fraction, stage))
    )
    fractions = [fraction for fraction, _ in calls]
    assert fractions and fractions == sorted(fractions)
    assert 0 <= fractions[0] < fractions[-1] == 1
    assert all(isinstance(stage, str) and stage for _, stage in calls)


def test_progress_can_cancel(amplitude_patch, make_scene):
    scene = make_scene()
    with pytest.raises(sonject.Cancelled) as caught:
        sonject.inject(amplitude_patch, scene, progress=lambda fraction, stage: True)
    assert caught.value.status is sonject.Status.CANCELLED
    assert sonject.inject(amplitude_patch, scene).image.shape == (ROWS, COLUMNS)


def test_a_large_patch_tells_its_noise_floor_by_16_parts_and_can_be_cancelled_there(make_scene):
    shadows = numpy.ones((20000, 256), numpy.float32)
    for row in range(50, 20000, 100):
        shadows[row : row + 12, 100:140] = 0.1  # -20 dB
    patch = shadows * numpy.random.default_rng(2).rayleigh(size=shadows.shape).astype(numpy.float32)
    told = []
    result = sonject.inject(patch, make_scene(), progress=lambda fraction, stage: told.append(stage))
    assert told.count("looking for shadows") == 16
    assert result.statistics.noise_floor_db == pytest.approx(-20, abs=0.5)
    with pytest.raises(sonject.Cancelled, match="cancelled while looking for shadows"):
        sonject.inject(patch, make_scene(), progress=lambda fraction, stage: "shadows" in stage)


@pytest.mark.parametrize("kind", [ZeroDivisionError, KeyboardInterrupt])
def test_what_progress_raises_is_raised(amplitude_patch, make_scene, kind):
    def progress(fraction, stage):
        raise kind("from the callback")

    with pytest.raises(kind, match="from the callback"):
        sonject.inject(amplitude_patch, make_scene(), progress=progress)


def signal_while_it_works(number):
    """Returns a progress function; a thread sends the signal while the library works on."""
    told = []

    def send():
        time.sleep(0.02)
        os.kill(os.getpid(), number)

    def progress(fraction, stage):
        told.append(fraction)
        if len(told) == 1:
            threading.Thread(target=send).start()

    return progress, told


def test_ctrl_c_ends_the_work_and_is_raised(make_scene, amplitude_patch, capfd):
    scene = make_scene(injection={"rays": 256, "interactions": 2})  # works for seconds
    progress, told = signal_while_it_works(signal.SIGINT)
    handler = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        sonject.inject(amplitude_patch, scene, progress=progress)
    assert told[-1] < 1
    assert signal.getsignal(signal.SIGINT) == handler
    assert "ignored" not in capfd.readouterr().err


def test_what_the_handler_of_a_signal_raises_is_raised(make_scene, amplitude_patch, request):
    scene = make_scene(injection={"rays": 256, "interactions": 2})

    def out_of_time(number, frame):
        raise TimeoutError("out of time")

    before = signal.signal(signal.SIGTERM, out_of_time)
    request.addfinalizer(lambda: signal.signal(signal.SIGTERM, before))
    progress, told = signal_while_it_works(signal.SIGTERM)
    with pytest.raises(TimeoutError, match="out of time"):
        sonject.inject(amplitude_patch, scene, progress=progress)
    assert told[-1] < 1
    assert signal.getsignal(signal.SIGTERM) == out_of_time


ELSEWHERE = """\
import _thread, time
told = []

def work():
    try:
        import threading  # takes this thread for the main one
        import sonject
        told.append(sonject.absorption("100 kHz", 12) > 0)
    finally:
        told.append(False)

_thread.start_new_thread(work, ())
while not told:
    time.sleep(0.01)
assert told[0]
"""


def test_another_programs_main_thread_keeps_its_handlers():
    """Python may run within a program, in a thread where no handler can be set."""
    subprocess.run([sys.executable, "-c", ELSEWHERE], check=True, timeout=60)


def test_a_callback_cannot_use_its_context(amplitude_patch, make_scene):
    scene = make_scene()
    with pytest.raises(RuntimeError, match="own callbacks"):
        sonject.inject(
            amplitude_patch, scene, progress=lambda fraction, stage: scene.object_count
        )


def test_garbage_collected_in_a_callback_is_released_afterwards(amplitude_patch, make_scene):
    doomed = [make_scene()]

    def progress(fraction, stage):
        doomed.clear()
        gc.collect()

    scene = make_scene()
    sonject.inject(amplitude_patch, scene, progress=progress)
    assert not scene.context._waiting


def test_the_file_of_a_scene_is_for_runs(make_scene, tmp_path):
    scene = make_scene()
    scene["input.path"] = tmp_path / "swath.npy"
    with pytest.raises(sonject.SonjectError, match=r"names a file.* sonject\.run\(scene, folder\)") as caught:
        sonject.inject(None, scene)
    assert "\n" not in str(caught.value)


def test_calls_release_the_global_lock():
    library = _library.load()  # ctypes holds the lock only during calls of a PyDLL
    assert isinstance(library, ctypes.CDLL) and not isinstance(library, ctypes.PyDLL)


def test_measure_takes_what_inject_gives(amplitude_patch, make_scene):
    result = sonject.inject(amplitude_patch, make_scene())
    told = sonject.measure(result.image, result.labels)
    assert 0.4 < told.amplitude_contrast < 0.7
    assert told.looks >= 1.0
    with pytest.raises(ValueError, match="labels"):
        sonject.measure(amplitude_patch, result.labels[1:])


TARGETS = pathlib.Path(__file__).resolve().parents[3] / "tools" / "targets"


def test_targets_have_the_pose_that_is_given(amplitude_patch, make_scene):
    scene = make_scene(input={"uniform": {"rows": ROWS, "columns": COLUMNS}, "geometry": GEOMETRY})
    scene["objects[0]"] = {"target": TARGETS / "boulder.yaml", "name": "stone",
                           "position": {"row": 70, "column": 100}, "level": {"over_seabed": 9}}
    assert "stone" in sonject.check(scene)
    truth = sonject.inject(amplitude_patch, scene).objects[0]
    assert truth.row == pytest.approx(70, abs=0.5)  # the middle of its parts lies 6 mm beside its origin
    assert 90 < truth.column < 100  # its centre is above the ground, so nearer
    assert truth.over_seabed_db == pytest.approx(9.0, abs=1e-4)


def test_another_thread_cancels(amplitude_patch, make_scene):
    """The call waits in a progress function until the other thread has asked it to stop."""
    is_running, is_asked = threading.Event(), threading.Event()

    def ask():
        is_running.wait()
        is_asked.set()

    def progress(fraction, stage):
        is_running.set()
        return is_asked.wait()

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    with pytest.raises(sonject.Cancelled):
        sonject.inject(amplitude_patch, make_scene(), progress=progress)
    thread.join()


def test_a_contact_is_measured():
    random = numpy.random.default_rng(5)
    image = random.rayleigh(0.1, (120, 160)).astype(numpy.float32)
    image[50:71, 60:72] *= 6
    image[50:71, 72:112] *= 0.05
    box = sonject.Box(40, 50, 41, 80)
    by_box = sonject.measure_contact(image, box, row_spacing_m="10 cm", column_spacing_m=0.05)
    found = sonject.measure_contact(image)
    # the tolerance is a pixel at each edge: edges lie between pixels, in speckle, without a point response
    assert by_box.shadow_range_pixels == pytest.approx(40, abs=2)
    assert by_box.highlight_along_pixels == pytest.approx(21, abs=2)
    assert 0 < by_box.shadow_range_error_pixels < 1 and by_box.dim_range_pixels == 0
    assert not by_box.is_cut and by_box.box == box
    assert by_box.shadow_range_m == pytest.approx(0.05 * by_box.shadow_range_pixels)
    assert found.shadow_range_pixels == pytest.approx(by_box.shadow_range_pixels, abs=0.5)
    assert numpy.isnan(found.shadow_range_m) and found.shadow.rows > 15
    with pytest.raises(sonject.SonjectError, match="not inside"):
        sonject.measure_contact(image, sonject.Box(100, 0, 30, 30))


@pytest.mark.parametrize("body, level", [
    ({"shape": "box", "length": 1.8, "width": 0.4, "height": 0.4, "heading": "20 deg"}, "10 dB"),
    ({"shape": "truncated_cone", "diameter": 1, "top_diameter": 0.5, "height": 0.4}, "15 dB")])
def test_errors_of_lengths_along_the_track_hold_for_rough_targets(context, body, level):
    """Their highlights fade towards the ends, or have lumps there."""
    errors = []
    for seed in range(1, 41):
        scene = sonject.Scene(
            sonar={"frequency": 100e3, "bandwidth": 30e3, "altitude": 10},
            input={"geometry": {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 38},
                   "synthetic": {"rows": 112, "columns": 224, "seed": seed, "speckle_shape": "inf", "ripple_contrast": 0,
                                 "patch_contrast": 0}},
            injection={"seed": seed}, context=context,
            objects=[{**body, "material": {"reflection": 0}, "position": {"row": 55, "column": 60},
                      "level": {"over_seabed": level}}])
        result = sonject.inject(None, scene)
        truth = result.objects[0]
        box = sonject.Box(*(max(0, first - 6) for first in (truth.both.first_row, truth.both.first_column)),
                          truth.both.rows + 12, truth.both.columns + 12)
        found = sonject.measure_contact(result.image, box)
        errors.append((found.highlight_along_pixels - truth.highlight_along_m / 0.025) / found.highlight_along_error_pixels)
    assert 0.7 < numpy.sqrt(numpy.mean(numpy.square(errors))) < 1.4
