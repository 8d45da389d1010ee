"""Grey levels in arrays: their transfer functions both ways, and injections into them."""

import json
import math
import pickle

import numpy
import pytest

import sonject

CURVES = {
    "amplitude": lambda q, v: q,
    "intensity": lambda q, v: numpy.sqrt(q),
    "{kind: decibel, parameter: 0.378, offset: -60 dB}": lambda q, v: 10 ** ((v * 0.378 - 60) / 20),
    "{kind: gamma, parameter: 2.2}": lambda q, v: q**2.2,
    "{kind: schlick, parameter: 3.9}": lambda q, v: q / (3.9 - 2.9 * q),
}


def transfer(text):
    return sonject.Transfer(text if text.startswith("{") else {"kind": text})


@pytest.mark.parametrize("text", CURVES)
def test_eight_bits_go_both_ways(text):
    levels = numpy.arange(256, dtype=numpy.uint8)
    amplitudes = transfer(text).to_amplitude(levels)
    v = levels.astype(float)
    assert amplitudes.dtype == numpy.float32 and amplitudes.shape == levels.shape
    # half a unit in the last place of single precision
    assert numpy.allclose(amplitudes, CURVES[text](v / 255, v), rtol=2.0**-24, atol=0)
    assert numpy.array_equal(transfer(text).from_amplitude(amplitudes), levels)


@pytest.mark.parametrize("kind, full_scale", [("uint8", 255), ("uint16", 65535), ("float32", 1)])
def test_types_have_their_full_scale(kind, full_scale):
    gamma = sonject.Transfer("{kind: gamma, parameter: 2}")
    stored = numpy.array([[0, full_scale]], kind)
    assert gamma.to_amplitude(stored).tolist() == [[0.0, 1.0]]
    back = gamma.from_amplitude([0.0, 0.25, 1.0, 2.0], kind)
    over = full_scale if full_scale > 1 else math.sqrt(2)
    half = 0.5 * full_scale if full_scale == 1 else (full_scale + 1) // 2
    assert back.dtype == kind and back.tolist() == [0, half, full_scale, pytest.approx(over)]


def test_arrays_of_any_arrangement_and_order_of_bytes():
    curve = sonject.Transfer("{kind: intensity}")
    levels = numpy.random.default_rng(1).integers(0, 65536, (3, 8, 10), numpy.uint16)
    expected = curve.to_amplitude(levels)
    assert expected.shape == levels.shape
    turned = levels.transpose(2, 1, 0)
    assert numpy.array_equal(curve.to_amplitude(turned), expected.transpose(2, 1, 0))
    assert numpy.array_equal(curve.to_amplitude(levels[0, ::-1, 1::2]), expected[0, ::-1, 1::2])
    assert numpy.array_equal(curve.to_amplitude(levels.astype(">u2")), expected)


def test_a_transfer_is_a_dictionary_of_keys(make_scene):
    curve = sonject.Transfer("{kind: decibel, parameter: 0.5, offset: -40 dB}")
    assert curve == {"kind": "decibel", "parameter": 0.5, "offset": -40.0}
    assert pickle.loads(pickle.dumps(curve)) == curve == sonject.Transfer(curve)
    scene = make_scene()
    scene["input.transfer"] = curve
    assert scene["input.transfer"] == curve


@pytest.mark.parametrize("keys, error, message", [
    ("{kind: gama, parameter: 2}", sonject.SonjectError, "did you mean 'gamma'"),
    ("{kind: decibel}", sonject.SonjectError, "this kind of transfer needs it"),
    ({"kind": "intensity", "parameter": 2}, sonject.SonjectError, "has none; remove it"),
    ("gamma", TypeError, r"such as \"\{kind: decibel, .*\", of a kind amplitude, .*, schlick; not 'gamma'"),
    (2.2, TypeError, "dictionary of keys or its text"),
])
def test_what_is_no_transfer_function_is_refused(keys, error, message):
    grey = numpy.ones((9, 9), numpy.uint8)
    for work in (sonject.Transfer, lambda curve: sonject.measure(grey, transfer=curve),
                 lambda curve: sonject.measure_contact(grey, transfer=curve)):
        with pytest.raises(error, match=message) as caught:
            work(keys)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("stored, error, message", [
    (numpy.zeros((0, 3), numpy.uint8), ValueError, r"not the shape \(0, 3\)"),
    (numpy.zeros((2, 2), numpy.int32), TypeError, "grey levels are uint8, uint16 or float32, not int32"),
    (numpy.zeros((2, 2), numpy.complex64), TypeError, "not complex64"),
    (numpy.array([[1.0, 2.0], [numpy.nan, 1.0]]), sonject.SonjectError,
     "row 1, column 0 is not a finite number"),
    (numpy.array([[-1.0]]), sonject.SonjectError, "row 0, column 0 is a negative amplitude"),
    (numpy.ma.masked_less(numpy.ones((2, 2), numpy.uint8), 2), TypeError, "masked"),
])
def test_grey_levels_that_tell_no_amplitude_are_refused(stored, error, message, make_scene):
    curve = {"kind": "intensity"}
    for work in (sonject.Transfer(curve).to_amplitude,
                 lambda patch: sonject.inject(patch, make_scene(), transfer=curve),
                 lambda patch: sonject.measure_contact(patch, transfer=curve)):
        with pytest.raises(error, match=message) as caught:
            work(stored)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("amplitudes, kind, error, message", [
    ([[0.1, numpy.nan]], "uint8", sonject.SonjectError, "row 0, column 1 is nan"),
    ([[-0.1]], "uint8", sonject.SonjectError, "row 0, column 0 is -0.1"),
    ([[1, 2]], "uint8", TypeError, "amplitudes are floating point numbers, not int"),
    ([[0.5]], "int16", TypeError, "grey levels are uint8, uint16 or float32, not int16"),
])
def test_amplitudes_that_have_no_grey_level_are_refused(amplitudes, kind, error, message):
    with pytest.raises(error, match=message):
        sonject.Transfer("{kind: gamma, parameter: 2}").from_amplitude(amplitudes, kind)


def grey_levels(kind, curve, amplitudes):
    """A picture with faults: clipped pixels, a row where nothing was heard, steps of 16 bits."""
    if kind == "uint16":
        levels = 257 * sonject.Transfer(curve).from_amplitude(amplitudes, "uint8").astype("uint16")
    else:
        levels = sonject.Transfer(curve).from_amplitude(amplitudes, kind)
    levels[10] = 0
    return levels


@pytest.mark.parametrize("kind, curve", [
    ("uint8", "{kind: decibel, parameter: 0.378, offset: -100 dB}"),
    ("uint8", "{kind: amplitude, full_scale: 200}"),
    ("uint16", "{kind: gamma, parameter: 2}"),
    ("float32", "{kind: intensity}"),
])
def test_an_array_gives_the_bits_that_its_file_gives(kind, curve, amplitude_patch, make_scene, tmp_path):
    patch = grey_levels(kind, curve, 0.3 * amplitude_patch)
    objects = [{"shape": "sphere", "diameter": 0.5, "level": {"over_seabed": 25}}]
    result = sonject.inject(patch, make_scene(objects=objects), transfer=curve)
    scene = make_scene(objects=objects)
    numpy.save(tmp_path / "swath.npy", patch)
    scene["input"] = {**scene["input"], "path": tmp_path / "swath.npy",
                      "transfer": sonject.Transfer(curve)}
    sonject.run(scene, tmp_path / "out")
    image = numpy.load(tmp_path / "out" / "image.npy")
    assert result.image.dtype == image.dtype == kind
    assert result.image.tobytes() == image.tobytes()
    untouched = result.influence == 0
    assert untouched[10].all() and not untouched[9:12].all()
    assert numpy.array_equal(result.image[untouched], patch[untouched])
    assert numpy.any(result.image[~untouched] != patch[~untouched])
    assert kind != "uint16" or not numpy.any(result.image % 257)
    told = (tmp_path / "out" / "run.json").read_text()
    for name in ("input_clipped", "output_clipped"):
        assert f'"{name}_pixels": {getattr(result.statistics, name)},' in told, name
    assert result.statistics.output_clipped > 0 or kind == "float32"
    (truth,) = json.loads((tmp_path / "out" / "truth.json").read_text())["objects"]
    assert result.objects[0].highlight_clipped == pytest.approx(truth["highlight_clipped"], rel=1e-6)


def test_what_takes_an_image_takes_its_transfer(amplitude_patch, make_scene):
    curve = sonject.Transfer("{kind: gamma, parameter: 2}")
    result = sonject.inject(curve.from_amplitude(0.3 * amplitude_patch), make_scene(), transfer=curve)
    linear = curve.to_amplitude(result.image)
    assert result.transfer == curve
    for measure in (sonject.measure, sonject.measure_contact):  # texts, in which NaN is NaN
        assert repr(measure(result.image, transfer=curve)) == repr(measure(linear))
    assert result._repr_html_().startswith("<img")


def test_no_element_hears_a_transfer(amplitude_patch, make_scene):
    scene = make_scene(elements={"hydrophones": {"count": 2}})
    curve = sonject.Transfer("{kind: intensity}")
    grey = curve.from_amplitude(0.3 * amplitude_patch)
    series = sonject.element_series(grey, scene, transfer=curve)
    assert numpy.array_equal(series, sonject.element_series(curve.to_amplitude(grey), scene))


def test_the_transfer_of_a_scene_is_that_of_its_file(amplitude_patch, make_scene):
    """Grey levels without a transfer are refused, and the message's advice works."""
    scene = make_scene()
    scene["input.transfer"] = {"kind": "gamma", "parameter": 2}
    grey = sonject.Transfer(scene["input.transfer"]).from_amplitude(0.3 * amplitude_patch)
    with pytest.raises(TypeError, match="is that of its file alone: pass transfer=scene") as caught:
        sonject.inject(grey, scene)
    advice = str(caught.value).rpartition("pass transfer=")[2]
    assert sonject.inject(grey, scene, transfer=eval(advice)).image.dtype == numpy.uint8


def test_complex_pixels_have_no_transfer(complex_patch, make_scene):
    with pytest.raises(TypeError, match="not complex64"):
        sonject.inject(complex_patch, make_scene(), transfer={"kind": "amplitude"})
