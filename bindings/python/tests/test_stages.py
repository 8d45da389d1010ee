"""Tracing and image formation in separate calls."""


import numpy
import pytest

import sonject
from conftest import KEYS


def make_scene(bandwidth_hz=30e3):
    scene = sonject.Scene(**KEYS)
    scene["sonar.bandwidth"] = bandwidth_hz
    scene["input.uniform"] = {"rows": 40, "columns": 50}
    scene["objects[0].diameter"] = 0.3
    return scene


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != "run.json"}


def test_a_scene_in_memory_is_formed_with_the_scene_at_hand(tmp_path):
    impulses = tmp_path / "impulses.sums"
    sonject.trace(make_scene(), impulses)
    assert sonject.form(impulses, tmp_path / "formed alone")  # the file keeps the scene's text
    for bandwidth_hz in (30e3, 29.9e3):  # the fine grids of both are the same
        scene = make_scene(bandwidth_hz)
        formed = tmp_path / f"formed {bandwidth_hz}"
        assert sonject.form(impulses, formed, scene=scene)
        assert not sonject.form(impulses, formed, scene=scene)
        assert sonject.run(scene, tmp_path / f"run {bandwidth_hz}")
        assert contents(formed) == contents(tmp_path / f"run {bandwidth_hz}")
    assert contents(tmp_path / "formed alone") == contents(tmp_path / f"run {30e3}")
    # the last bandwidth was not that of this folder's result
    folder = tmp_path / f"formed {30e3}"
    for write in (lambda **options: sonject.form(impulses, folder, scene=scene, **options),
                  lambda **options: sonject.run(make_scene(), folder, **options)):
        with pytest.raises(sonject.SonjectError, match=r"differs in sonar: .*--overwrite"):
            write()
        assert write(overwrites=True)
    other = make_scene()
    other["objects[1]"] = {"shape": "sphere", "diameter": 0.2}
    with pytest.raises(sonject.SonjectError, match="not what was traced"):
        sonject.form(impulses, tmp_path / "other", scene=other)
    with pytest.raises(sonject.SonjectError, match="takes no overrides"):
        sonject.form(impulses, tmp_path / "other", {"sonar.bandwidth": "29 kHz"}, make_scene())


def test_progress_ends_at_one(tmp_path):
    scene, sums, parts = make_scene(), tmp_path / "impulses.sums", tmp_path / "parts"
    patch = numpy.full((40, 50), 0.1, numpy.float32)
    works = [
        lambda tell: sonject.inject(patch, scene, tell),
        lambda tell: sonject.run(scene, tmp_path / "run", tell),
        lambda tell: sonject.run(scene, tmp_path / "run", tell),  # there is nothing left to do
        lambda tell: sonject.trace(scene, sums, tell),
        lambda tell: sonject.form(sums, tmp_path / "formed", progress=tell),
        lambda tell: sonject.run(scene, parts, tell, shard=(1, 1)),
        lambda tell: sonject.merge(parts, scene, tell),
    ]
    for number, work in enumerate(works):
        told = []
        work(lambda fraction, stage: told.append(fraction) or fraction == 1)  # too late to cancel
        assert told == sorted(told) and told.count(1) == 1, number


def test_progress_cancels_both_stages(tmp_path):
    impulses = tmp_path / "impulses.sums"
    with pytest.raises(sonject.Cancelled):
        sonject.trace(make_scene(), impulses, progress=lambda fraction, stage: True)
    assert not list(tmp_path.iterdir())
    sonject.trace(make_scene(), impulses)
    with pytest.raises(sonject.Cancelled):
        sonject.form(
            impulses, tmp_path / "a", scene=make_scene(), progress=lambda fraction, stage: True
        )
    assert not (tmp_path / "a" / "run.json").exists()


def test_a_run_cancelled_at_any_call_has_no_result_and_goes_on(tmp_path):
    """Not even with the last rays, when all is traced but not all is formed."""
    told = []
    sonject.run(make_scene(), tmp_path / "whole", lambda fraction, stage: told.append(stage))
    image = (tmp_path / "whole" / "image.tif").read_bytes()
    stopped = 0
    for number in range(len(told)):
        folder, calls = tmp_path / str(number), iter(range(number))
        try:
            sonject.run(make_scene(), folder, lambda fraction, stage: next(calls, None) is None)
        except sonject.Cancelled:
            assert not (folder / "run.json").exists()
            stopped += 1
            sonject.run(make_scene(), folder)
        assert (folder / "image.tif").read_bytes() == image, told[number]
    assert stopped > 2
