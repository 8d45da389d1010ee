"""Element level: the beamformed series of the hydrophones are the image that sonject forms."""

import dataclasses
import json
import pathlib
import runpy
import sys

import numpy
import pytest

import sonject

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

from delay_and_sum import delay_and_sum, read  # noqa: E402

ROWS, COLUMNS, SPACING, FIRST_RANGE = 32, 40, 0.025, 20.0
RADIUS = 0.03
MIDDLE = (15, 22)
PATCH = numpy.ones((ROWS, COLUMNS), numpy.float32)

SMOOTH = dict(reflection=1, roughness=0, lambert=0)
ROUGH = dict(reflection=0, lambert=0.2)


def scene_of(context, material, *, elements, side="port", lambert=1e-9, medium=None, **injection):
    row, column = MIDDLE
    sphere = dict(shape="sphere", diameter=2 * RADIUS, material=material, burial=-0.2,
                  position={"row": row, "column": column})
    geometry = dict(row_spacing=SPACING, column_spacing=SPACING, first_slant_range=FIRST_RANGE,
                    side=side)
    return sonject.Scene(
        sonar={"frequency": 100e3, "bandwidth": 30e3, "altitude": 10,
               "response": "rectangular"},  # the beamformer weights aspects evenly
        input={"geometry": geometry},
        seabed={"lambert": lambert},
        medium=medium or {},
        injection=injection,
        elements=elements,
        objects=[] if material is None else [sphere],
        context=context,
    )


def beamform(series, layout, along_track, slant_range):
    elements = layout.elements
    return delay_and_sum(
        series,
        transmitter_m=layout.transmitter_m,
        hydrophones_m=layout.hydrophones_m,
        along_track_m=along_track,
        slant_range_m=slant_range,
        sampling_rate_hz=elements.sampling_rate_hz,
        first_time_s=elements.first_time_s,
        sound_speed_mps=layout.sound_speed_mps,
        centre_frequency_hz=layout.centre_frequency_hz,
        resolution_m=layout.along_track_resolution_m,
        transmitter_length_m=elements.transmitter_length_m,
        hydrophone_length_m=elements.hydrophone_length_m,
    )


def axes():
    return SPACING * numpy.arange(ROWS), FIRST_RANGE + SPACING * numpy.arange(COLUMNS)


def decibels(ratio):
    return 20 * numpy.log10(ratio)


ARRAYS = {
    "one hydrophone": {},
    "towed behind the transmitter": {"hydrophones": {"count": 6, "spacing": 0.05, "first": -0.3},
                                     "transmitter": {"offset": 0.4}},
    "points": {"hydrophones": {"count": 2, "spacing": 0.04, "length": 0},
               "transmitter": {"length": 0}},
}


@pytest.mark.parametrize("side", ["port", "starboard"])
@pytest.mark.parametrize("name", ARRAYS)
def test_a_point_focuses_where_it_is_with_its_level(context, name, side):
    """A small smooth sphere has the amplitude a / 2 at its nearest point. The cross-range response
    takes off 0.03 dB: 10 log10 of its loss for a sphere of this radius (kernels/MATH.md)."""
    scene = scene_of(context, SMOOTH, elements=ARRAYS[name], side=side)
    series = sonject.element_series(PATCH, scene)
    layout = sonject.element_layout(scene, PATCH.shape)
    assert series.shape == layout.shape and series.dtype == numpy.complex64
    truth = sonject.inject(PATCH, scene).objects[0]
    steps = numpy.arange(-16, 17) / 16 * 1.5 * SPACING
    nearest = truth.slant_range_m - RADIUS
    image = numpy.abs(beamform(series, layout, truth.along_track_m + steps, nearest + steps))
    row, column = numpy.unravel_index(image.argmax(), image.shape)
    assert abs(steps[row]) <= 0.1 * SPACING
    assert abs(steps[column]) <= 0.1 * SPACING
    assert decibels(image.max() / (RADIUS / 2)) == pytest.approx(0, abs=0.2)


def compare(formed, image):
    """Returns correlation, phase between both, and level of the second over the first in dB."""
    product = numpy.vdot(formed, image)
    norms = numpy.linalg.norm(formed), numpy.linalg.norm(image)
    return abs(product) / (norms[0] * norms[1]), numpy.angle(product), decibels(norms[1] / norms[0])


def speckle_scene(context, elements):
    return scene_of(context, ROUGH, elements=elements, lambert=0.002, mode="resynthesise")


def test_speckle_is_the_images_own(context):
    """A rough sphere on a seabed, realisation by realisation. The rest is what image formation
    simplifies (kernels/MATH.md): far side lobes have no curvature, and the response has one
    frequency. As strips are as wide as the resolution, aspects beyond the aperture repeat those
    within, by the mean relative distance of the pulse's frequencies from the centre: 0.19 dB."""
    scene = speckle_scene(context, ARRAYS["one hydrophone"])
    formed = sonject.inject(PATCH, scene).field
    layout = sonject.element_layout(scene, PATCH.shape)
    image = beamform(sonject.element_series(PATCH, scene), layout, *axes())
    correlation, phase, level = compare(formed, image)
    assert correlation > 0.98
    assert abs(phase) < 0.02
    assert abs(level) < 0.25


def test_an_aperture_cut_at_the_target_leaves_less(context):
    """Aspects are cut in the image's along-track spectrum, where W is a rectangle, instead of by
    the distance from the pixel. The side lobes' curvature and most of the change with frequency
    vanish. The array sees more aspects than the image takes."""
    wider, fine, margin = 1.5, 2, 40 * SPACING
    array = {"hydrophones": {"length": 0.02}, "transmitter": {"length": 0.02},
             "pings": {"spacing": 0.0125, "count": 900}}
    scene = speckle_scene(context, array)
    formed = sonject.inject(PATCH, scene).field
    layout = sonject.element_layout(scene, PATCH.shape)
    resolution = layout.along_track_resolution_m
    wide = dataclasses.replace(layout, along_track_resolution_m=resolution / wider)
    along_track, slant_range = axes()
    rows = numpy.arange(-margin, along_track[-1] + margin, SPACING / fine)
    image = wider * beamform(sonject.element_series(PATCH, scene), wide, rows, slant_range)
    spectrum = numpy.fft.fft(image, axis=0)
    spectrum[numpy.abs(numpy.fft.fftfreq(len(rows), SPACING / fine)) > 0.5 / resolution] = 0
    first = round(margin / SPACING) * fine
    image = numpy.fft.ifft(spectrum, axis=0)[first : first + fine * ROWS : fine]
    correlation, phase, level = compare(formed, image)
    assert correlation > 0.99
    assert abs(phase) < 0.01
    assert abs(level) < 0.1


def test_a_rough_target_has_the_images_place_and_level(context):
    """The deviates are those of the image. Simplifications of image formation still move the peak
    of a target of few cells by 0.2 dB rms either way: the mean of six is compared."""
    levels = []
    for seed in range(1, 7):
        scene = scene_of(
            context, ROUGH, elements={}, mode="resynthesise", seed=seed
        )
        formed = numpy.abs(sonject.inject(PATCH, scene).field)
        layout = sonject.element_layout(scene, PATCH.shape)
        image = numpy.abs(beamform(sonject.element_series(PATCH, scene), layout, *axes()))
        assert image.argmax() == formed.argmax()
        levels.append(decibels(image.max() / formed.max()))
    assert numpy.mean(levels) == pytest.approx(0, abs=0.2)


def test_a_coherent_seabed_is_heard_as_it_is_drawn(context):
    random = numpy.random.default_rng(7)
    patch = random.standard_normal((2, ROWS, COLUMNS)).astype(numpy.float32)
    patch = patch[0] + 1j * patch[1]
    scene = speckle_scene(context, ARRAYS["one hydrophone"])
    scene["seabed"] = {"map": "coherent"}
    formed = sonject.inject(patch, scene).field
    layout = sonject.element_layout(scene, patch.shape)
    image = beamform(sonject.element_series(patch, scene), layout, *axes())
    correlation, phase, _ = compare(formed, image)
    assert correlation > 0.98
    assert abs(phase) < 0.02


def test_delays_are_those_of_the_processors_sound_speed(context):
    """The true sound is 2 % slower than the processor assumes: targets have place and level as in
    its image."""
    scene = scene_of(context, SMOOTH, elements=ARRAYS["one hydrophone"],
                     medium={"sound_speed": 1470, "reference_sound_speed": 1500})
    layout = sonject.element_layout(scene, PATCH.shape)
    assert layout.sound_speed_mps == 1500.0
    formed = numpy.abs(sonject.inject(PATCH, scene).field)
    image = numpy.abs(beamform(sonject.element_series(PATCH, scene), layout, *axes()))
    assert image.argmax() == formed.argmax()
    assert decibels(image.max() / formed.max()) == pytest.approx(0, abs=0.2)


def few_pings(**more):
    return {"pings": {"count": 3, "first": 0.1, "spacing": 0.4}, **more}


def test_passband_is_baseband_on_its_carrier(context):
    times = dict(first_time=0.0265, last_time=0.0285, sampling_rate=400e3)
    base = sonject.element_series(
        PATCH, scene_of(context, SMOOTH, elements=few_pings(**times))
    )
    scene = scene_of(context, SMOOTH, elements=few_pings(form="passband", **times))
    passed = sonject.element_series(PATCH, scene)
    carrier = numpy.exp(-2j * numpy.pi * 100e3 * sonject.element_layout(scene, PATCH.shape).times_s)
    assert passed.dtype == numpy.float32
    expected = (base * carrier).real
    # errors of single precision in carrier and product
    assert numpy.abs(passed - expected).max() <= 1e-6 * numpy.abs(base).max()
    assert numpy.abs(base).max() > 0


def test_a_chirp_compresses_to_the_echo(context):
    """A matched filter peaks at the echo's delay, with the chirp's energy times its level. The
    sphere's false echo, half a radius of sound behind, is 40 dB down."""
    duration = 2e-3
    chirped = few_pings(pulse="chirp", chirp=duration, sampling_rate=120e3)
    scene = scene_of(context, SMOOTH, elements=chirped)
    series = sonject.element_series(PATCH, scene)
    layout = sonject.element_layout(scene, PATCH.shape)
    rate = layout.elements.sampling_rate_hz
    compressed_scene = scene_of(
        context,
        SMOOTH,
        elements=few_pings(
            sampling_rate=rate,
            first_time=layout.elements.first_time_s,
            last_time=layout.elements.last_time_s,
        ),
    )
    compressed = sonject.element_series(PATCH, compressed_scene)
    time = numpy.arange(int(duration * rate) + 1) / rate - duration / 2
    replica = numpy.exp(-1j * numpy.pi * layout.bandwidth_hz / duration * time**2)
    for one, other in zip(series[:, 0], compressed[:, 0]):
        filtered = numpy.correlate(one, replica, "full")[len(replica) - 1 :] / (duration * rate)
        peak, expected = numpy.abs(filtered).argmax(), numpy.abs(other).argmax()
        assert abs(peak - expected) <= 1  # samples, a quarter of the resolution each
        # the peak may lie half a sample off: 0.1 dB of a sinc, 0.1 dB of the Gaussian
        assert abs(decibels(abs(filtered[peak]) / abs(other[expected]))) < 0.25


def test_the_composite_seabed_is_silent_and_the_resynthesised_one_is_not(context):
    array = few_pings()
    silent = sonject.element_series(PATCH, scene_of(context, None, elements=array, lambert=0.002))
    assert numpy.all(silent == 0)
    heard = sonject.element_series(
        PATCH, scene_of(context, None, elements=array, lambert=0.002, mode="resynthesise")
    )
    assert numpy.all(numpy.abs(heard).max(axis=2) > 0)


def test_chains_of_interactions_are_heard(context):
    array = few_pings()
    energies = []
    for interactions in (1, 2):
        series = sonject.element_series(
            PATCH, scene_of(context, ROUGH, elements=array, lambert=0.3, interactions=interactions)
        )
        energies.append(numpy.linalg.norm(series))
    assert energies[1] > 1.001 * energies[0]


def test_aspects_beyond_the_limit_are_left_out(context):
    far = dict(pings={"count": 2, "first": 0.4, "spacing": 6}, first_time=0.026, last_time=0.032)
    limit = {"aspect_limit": "0.2 rad"}
    whole, limited = (
        sonject.element_series(PATCH, scene_of(context, SMOOTH, elements=elements))
        for elements in (far, far | limit)
    )
    assert numpy.array_equal(limited[0], whole[0]) and numpy.abs(whole[0]).max() > 0
    assert numpy.all(limited[1] == 0) and numpy.abs(whole[1]).max() > 0


def test_a_source_level_makes_pressures(context):
    """The sonar equation: SL - absorption on the way there and back, at the water's own sound speed
    instead of the processor's; and sqrt(2) from rms to amplitude."""
    array = {"pings": {"count": 1}, "hydrophones": {"count": 2}}
    level, absorption, true_speed, assumed_speed = 217.0, 0.05, 1500.0, 1450.0
    medium = {"sound_speed": true_speed, "reference_sound_speed": assumed_speed,
              "absorption": absorption}
    scenes = [scene_of(context, SMOOTH, elements=elements, medium=medium)
              for elements in (array, array | {"source_level": level})]
    ratio, pressure = (sonject.element_series(PATCH, scene) for scene in scenes)
    below = (FIRST_RANGE + MIDDLE[1] * SPACING) * true_speed / assumed_speed  # of the seabed there
    altitude, centre = 10.0, 0.2 + RADIUS
    range_m = numpy.hypot(numpy.sqrt(below**2 - altitude**2), altitude - centre) - RADIUS
    expected = level - 120 + decibels(numpy.sqrt(2)) - 2 * absorption * range_m
    measured = decibels(numpy.abs(pressure).max() / numpy.abs(ratio).max())
    # a bin off in range would be 0.002 dB, the processor's sound speed 0.07 dB
    assert measured == pytest.approx(expected, abs=0.01)


def test_what_is_wrong_is_told(context):
    for match, elements, injection in (
        ("the window from 0.5 s to .* is empty", {"first_time": 0.5}, {}),
        ("more than 2\\^22", {"first_time": 0, "last_time": 30}, {}),
        ("use connect for elements", {},
         {"mode": "resynthesise", "estimator": "brute_force"}),
    ):
        with pytest.raises(sonject.SonjectError, match=match) as caught:
            scene = scene_of(context, SMOOTH, elements=elements)
            scene["injection"] = injection
            scene["sonar.transducer"] = 0.1
            sonject.element_series(PATCH, scene)
        assert caught.value.status is sonject.Status.ERROR_INPUT


def test_a_true_answer_cancels(context):
    scene = scene_of(context, SMOOTH, elements=few_pings())
    stages = []
    with pytest.raises(sonject.Cancelled, match="hearing"):
        sonject.element_series(
            PATCH, scene, lambda done, stage: stages.append((done, stage)) or "hearing" in stage
        )
    assert [done for done, _ in stages] == sorted(done for done, _ in stages)


def test_the_files_are_the_series(context, tmp_path, monkeypatch):
    scene, other = (scene_of(context, SMOOTH, elements={"pings": {"spacing": spacing}})
                    for spacing in (0.1, 0.2))
    for each in scene, other:
        each["input.uniform"] = {"rows": ROWS, "columns": COLUMNS}
    sonject.run_elements(scene, tmp_path)
    with pytest.raises(sonject.SonjectError, match="differs in elements"):
        sonject.run_elements(other, tmp_path)
    sonject.run_elements(other, tmp_path, overwrites=True)
    sonject.run_elements(scene, tmp_path, overwrites=True)
    series, geometry, image = read(tmp_path)
    assert numpy.array_equal(series, sonject.element_series(None, scene))
    layout = sonject.element_layout(scene)
    assert numpy.array_equal(geometry["transmitter_m"], layout.transmitter_m)
    assert numpy.array_equal(geometry["hydrophones_m"], layout.hydrophones_m)
    assert (image["rows"], image["columns"]) == PATCH.shape
    assert json.loads((tmp_path / "elements.json").read_text())["heard"] == "targets"
    monkeypatch.setattr(sys, "argv", ["delay_and_sum.py", str(tmp_path)])
    runpy.run_path(str(EXAMPLES / "delay_and_sum.py"), run_name="__main__")
    expected = numpy.unravel_index(
        numpy.abs(sonject.inject(PATCH, scene).field).argmax(), PATCH.shape
    )
    formed = numpy.load(tmp_path / "image.npy")
    assert numpy.unravel_index(numpy.abs(formed).argmax(), formed.shape) == expected
