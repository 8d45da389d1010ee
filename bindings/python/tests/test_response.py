"""Pulses, measured responses and residual motion."""

import numpy
import pytest

import sonject

BANDWIDTH = 30e3
CELL = 1500.0 / (2.0 * BANDWIDTH)


def gaussian(ranges_m):
    return numpy.exp(-2.0 * numpy.log(2.0) * (ranges_m / CELL) ** 2)


def field(scene, patch):
    return sonject.inject(patch, scene).field


def test_a_table_of_the_default_pulse_changes_nothing_much(make_scene, amplitude_patch):
    ranges_m = numpy.arange(-40, 41) * CELL / 8.0
    # tables are taken as they are, not matched to the image
    injection = sonject.Injection(match_response="nominal")
    expected = field(make_scene(injection=injection), amplitude_patch)
    scene = make_scene(injection=injection)
    scene.set_pulse_table(3.0j * gaussian(ranges_m), ranges_m=ranges_m)
    by_range = field(scene, amplitude_patch)
    scene.set_pulse_table(gaussian(ranges_m), times_s=ranges_m / 750.0)
    by_time = field(scene, amplitude_patch)
    # the cubic between eight samples a cell errs by 1e-4 of the brightest pixel
    largest = numpy.abs(expected).max()
    assert numpy.abs(by_range - expected).max() < 2e-3 * largest
    assert numpy.abs(by_time - by_range).max() < 1e-5 * largest
    scene.set_pulse_table([], ranges_m=[])
    assert numpy.array_equal(field(scene, amplitude_patch), expected)


def test_pulse_and_motion_change_the_target(make_scene, amplitude_patch):
    plain = field(make_scene(), amplitude_patch)
    chirp = make_scene()
    chirp.set_pulse(sonject.Pulse(kind="chirp", window="hann"))
    assert not numpy.array_equal(field(chirp, amplitude_patch), plain)
    moved = make_scene()
    moved.set_motion(sonject.Motion(sways=[(1e-3, 1.0, 0.0)]))
    defocused = field(moved, amplitude_patch)
    assert not numpy.array_equal(defocused, plain)
    moved.set_motion(sonject.Motion())
    assert numpy.array_equal(field(moved, amplitude_patch), plain)
    moved.set_motion_table([-10.0, 0.0, 10.0], [0.0, 2e-3, 0.0])
    assert not numpy.array_equal(field(moved, amplitude_patch), plain)
    moved.set_motion_table([], [])
    moved.set_motion(sonject.Motion(yaw_advance_m=0.4, yaws=[(2e-3, 2.0, 0.0)]))
    assert not numpy.array_equal(field(moved, amplitude_patch), plain)
    moved.set_motion(sonject.Motion(yaw_advance_m=0.4))
    assert numpy.array_equal(field(moved, amplitude_patch), plain)
    moved.set_yaw_table([-10.0, 10.0], [2e-3, 2e-3])
    assert not numpy.array_equal(field(moved, amplitude_patch), plain)
    moved.set_yaw_table([], [])
    distances_m = numpy.arange(-20, 21) * 0.01
    moved.set_cross_range_table(distances_m, numpy.exp(-0.5 * (distances_m / 0.03) ** 2))
    assert not numpy.array_equal(field(moved, amplitude_patch), plain)


def test_refusals(make_scene):
    scene = make_scene()
    with pytest.raises(ValueError, match="either ranges_m or times_s"):
        scene.set_pulse_table([0.0, 1.0, 0.5, 0.0])
    with pytest.raises(ValueError, match="4 values, ranges_m has 3"):
        scene.set_pulse_table([0.0, 1.0, 0.5, 0.0], ranges_m=[-1.0, 0.0, 1.0])
    with pytest.raises(sonject.SonjectError, match="pulse table: sample 1: its value must be"):
        scene.set_pulse_table([0.0, numpy.nan, 0.5, 0.0], ranges_m=[-1.0, 0.0, 1.0, 2.0])
    with pytest.raises(sonject.SonjectError, match="set it first"):
        scene.set_pulse(sonject.Pulse(kind="table"))
    with pytest.raises(ValueError, match="sways must be at most 8, not 9"):
        scene.set_motion(sonject.Motion(sways=[(0.0, 1.0, 0.0)] * 9))
    with pytest.raises(ValueError, match="amplitude_m, wavelength_m and phase_rad"):
        scene.set_motion(sonject.Motion(sways=[(0.0, 1.0)]))
    with pytest.raises(sonject.SonjectError, match="wavelength must be"):
        scene.set_motion(sonject.Motion(sways=[(0.0, 0.0, 0.0)]))
    with pytest.raises(sonject.SonjectError, match="motion table: sample 1"):
        scene.set_motion_table([0.0, 0.0], [0.0, 0.0])
    with pytest.raises(sonject.SonjectError, match="yaw table: sample 1: its yaw must be"):
        scene.set_yaw_table([0.0, 1.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="yaws must be at most 8, not 9"):
        scene.set_motion(sonject.Motion(yaws=[(0.0, 1.0, 0.0)] * 9))
