"""The water: its absorption, layers and profiles."""

import math

import numpy
import pytest

import sonject


def test_absorption_of_sea_water():
    alpha = sonject.absorption(100e3, 10.0)
    assert alpha == pytest.approx(34e-3, rel=0.02)  # handbooks: 34 dB/km
    assert alpha == sonject.absorption(
        frequency_hz=100e3, temperature_celsius=10, salinity_permille=35, depth_m=0, ph=8
    )
    assert sonject.absorption(numpy.float32(100e3), numpy.int64(10)) == alpha
    changed = [
        sonject.absorption(90e3, 10.0),
        sonject.absorption(100e3, 11.0),
        sonject.absorption(100e3, 10.0, 34.0),
        sonject.absorption(100e3, 10.0, 35.0, 10.0),
        sonject.absorption(100e3, 10.0, 35.0, 0.0, 7.9),
    ]
    assert len({alpha, *changed}) == 6
    assert math.isnan(sonject.absorption(2e6, 10.0))
    with pytest.raises(TypeError, match="frequency_hz must be a number"):
        sonject.absorption("100 kHz", 10.0)


def test_medium_absorbs_what_it_is_told(make_scene):
    assert sonject.Medium().absorption_db_per_m == 0.0
    medium = sonject.Medium(absorption_db_per_m=0.034)
    assert medium.to_structure().absorption_db_per_m == 0.034
    make_scene(medium=medium)
    with pytest.raises(sonject.SonjectError, match="absorption must be 0...100 dB/m, not -1"):
        make_scene(medium=sonject.Medium(absorption_db_per_m=-1.0))


def test_layers_are_lists_or_arrays(make_scene, amplitude_patch):
    scene = make_scene()

    def image(*layers):
        scene.set_water_layers(*layers)
        return sonject.inject(amplitude_patch, scene).image.tobytes()

    without = image([], [])
    layered = image([0, 5], [1490, 1520])
    assert layered != without
    assert image((0.0, 5.0), (1490.0, 1520.0), [1025, 1024]) != without
    speeds = numpy.array([1490, 1520], dtype=numpy.float32)
    assert image(numpy.array([0, 3, 5])[::2], speeds) == layered
    assert image(numpy.zeros(1), numpy.array([1490.0])) != layered
    assert image([], []) == without


def test_values_reach_the_library_in_order(make_scene):
    scene = make_scene()
    with pytest.raises(sonject.SonjectError) as caught:
        scene.set_water_layers([0.0, 12.0, 11.5], [1490.0, 1500.0, 1510.0])
    assert caught.value.status is sonject.Status.ERROR_INPUT
    assert "layers[2].bottom" in caught.value.message and "11.5 m" in caught.value.message
    with pytest.raises(sonject.SonjectError, match=r"layers\[1\].sound_speed .* not 15"):
        scene.set_water_layers([0.0, 12.0], numpy.array([0.0, 1490.0, 1.0, 15.0])[1::2])
    with pytest.raises(sonject.SonjectError, match=r"layers\[1\].density .* not -2"):
        scene.set_water_layers([0.0, 12.0], [1490.0, 1500.0], [1.0, -2.0])
    with pytest.raises(sonject.SonjectError, match=r"heights\[1\] must lie over .* 9 m"):
        scene.set_sound_speed_profile([10.0, 9.0], [1490.0, 1500.0])
    with pytest.raises(sonject.SonjectError, match=r"sound_speeds\[0\] .* not nan"):
        scene.set_sound_speed_profile([9.0, 10.0], [math.nan, 1500.0])
    with pytest.raises(sonject.SonjectError, match="at least two samples"):
        scene.set_sound_speed_profile([9.0], [1500.0])


def test_what_is_no_row_of_numbers_is_refused(make_scene):
    scene = make_scene()
    with pytest.raises(ValueError, match="sound_speeds_mps has 3 values, bottoms_m has 2"):
        scene.set_water_layers([0, 12], [1490, 1500, 1510])
    with pytest.raises(ValueError, match="densities has 1 values, bottoms_m has 2"):
        scene.set_water_layers([0, 12], [1490, 1500], [1025])
    with pytest.raises(ValueError, match="heights_m must be in one row"):
        scene.set_sound_speed_profile([[0, 12]], [1490, 1500])
    with pytest.raises(ValueError, match="bottoms_m must be in one row"):
        scene.set_water_layers(0.0, [1490])
    with pytest.raises(TypeError, match="heights_m must be numbers"):
        scene.set_sound_speed_profile(["0 m", "12 m"], [1490, 1500])
    with pytest.raises(TypeError, match="sound_speeds_mps must be numbers"):
        scene.set_sound_speed_profile([0, 12], [1490, 1500 + 1j])
    with pytest.raises(TypeError, match="masked"):
        scene.set_sound_speed_profile([0, 12], numpy.ma.array([1490, 1500], mask=[0, 1]))


def test_a_profile_is_taken(make_scene, amplitude_patch):
    scene = make_scene()
    without = sonject.inject(amplitude_patch, scene).image.tobytes()
    scene.set_sound_speed_profile(numpy.linspace(0, 20, 5), [1490, 1490, 1500, 1510, 1510])
    assert sonject.inject(amplitude_patch, scene).image.tobytes() != without
    scene.set_water_layers([], [])
    assert sonject.inject(amplitude_patch, scene).image.tobytes() == without
