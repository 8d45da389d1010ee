"""Tests of the displays in interpreters and notebooks."""

import base64
import io
import re
import sys
import types

import numpy
import pytest
from PIL import Image

import sonject
from sonject import _picture
from conftest import COLUMNS, KEYS, ROWS


def pixels_of(address):
    """Returns the grey levels of a PNG."""
    png = base64.b64decode(address.partition("base64,")[2])
    Image.open(io.BytesIO(png)).verify()  # checks the sums of its chunks
    image = Image.open(io.BytesIO(png))
    assert (image.format, image.mode) == ("PNG", "L")
    return numpy.array(image)


def test_one_line_says_what_it_is(context, make_scene, amplitude_patch):
    scene = make_scene()
    result = sonject.inject(amplitude_patch, scene)
    assert repr(scene) == "<sonject.Scene of 1 object>"
    assert repr(make_scene(objects=2 * KEYS["objects"])) == "<sonject.Scene of 2 objects>"
    assert repr(result) == f"<sonject.Result {ROWS} x {COLUMNS} pixels, 1 object>"
    assert repr(context) == "<sonject.Context on the default device>"
    scene["objects[0].diameter"] = -1
    assert repr(scene).startswith("<sonject.Scene: set objects[0].diameter: must be")
    scene.close()
    assert repr(scene) == "<sonject.Scene: this sonject scene was closed>"
    with sonject.Context(device="native") as other:
        assert repr(other) == "<sonject.Context on native>"
    assert repr(other) == "<sonject.Context that was closed>"


def test_a_callback_may_look_at_what_is_in_use(make_scene, amplitude_patch):
    scene, seen = make_scene(), []
    sonject.inject(amplitude_patch, scene, progress=lambda *_: seen.append(repr(scene)))
    assert seen[0] == "<sonject.Scene: a sonject context cannot be used within its own callbacks>"


def test_a_notebook_shows_the_image_and_the_truth(make_scene, complex_patch):
    result = sonject.inject(complex_patch, make_scene(objects=2 * KEYS["objects"]))
    shown = result._repr_html_()
    (address,) = re.findall(r'<img src="(data:image/png;base64,[^"]+)"', shown)
    levels = 20 * numpy.log10(numpy.abs(result.image.astype(complex)))
    low, high = numpy.quantile(levels, [0.03, 0.998])
    assert f"96 x 128 pixels, 2 objects; black {low:.1f} dB, white {high:.1f} dB" in shown
    expected = 255 * numpy.clip((levels - low) / (high - low), 0, 1)
    assert numpy.abs(pixels_of(address) - expected).max() < 0.501
    rows = [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", shown)[1:]]
    truth = result.objects[1]
    assert [row[0] for row in rows] == ["0", "1"]
    assert rows[1][3:5] == [f"{truth.slant_range_m:.2f}", f"{truth.target_strength_db:.1f}"]
    assert rows[1][6:] == [str(truth.highlight_pixels), str(truth.shadow_pixels)]
    assert "table" not in sonject.inject(complex_patch, make_scene(objects=[]))._repr_html_()
    result.close()
    assert result._repr_html_() is not None  # layers that were read outlive the result
    closed = sonject.inject(complex_patch, make_scene())
    closed.close()
    assert closed._repr_html_() is None


def test_large_images_are_averaged_and_levels_are_those_of_the_quicklook():
    image = numpy.zeros((1601, 7), numpy.float32)
    image[0:2, 0:3] = 2.0
    address, (low, high) = _picture.picture(image)
    grey = pixels_of(address)
    assert grey.shape == (534, 3)
    assert high == pytest.approx(10 * numpy.log10(4 * 6 / 9) + 10) and high - low == 20
    assert grey[0, 0] == 128 and not grey[1:].any() and not grey[0, 1:].any()
    random = numpy.random.default_rng(3).rayleigh(size=(300, 200))
    levels = _picture.decibels(random)
    low, high = _picture.grey_ends(levels)
    assert (levels < low).mean() == pytest.approx(0.03, abs=1e-3)
    assert (levels > high).mean() == pytest.approx(0.002, abs=1e-4)


def test_a_notebook_shows_the_text_of_a_scene(make_scene):
    scene = make_scene(objects=[{**KEYS["objects"][0], "name": "<ball>"}])
    shown = scene._repr_html_()
    assert shown.startswith("<pre>sonject: 1\n") and shown.endswith("</pre>")
    assert "&lt;ball&gt;" in shown and "<ball>" not in shown
    scene.close()
    assert scene._repr_html_() is None


class Tqdm:
    """The parts of tqdm that are used."""

    made: list = []

    def __init__(self, total, bar_format):
        assert total == 1.0 and "{desc}" in bar_format
        self.n, self.stages, self.is_closed = 0.0, [], False
        Tqdm.made.append(self)

    def set_description_str(self, text, refresh):
        self.stages.append(text)

    def update(self, step):
        assert step >= 0.0
        self.n += step

    def close(self):
        self.is_closed = True


@pytest.fixture
def bars(monkeypatch):
    module = types.ModuleType("tqdm.auto")
    module.tqdm = Tqdm
    monkeypatch.setitem(sys.modules, "tqdm.auto", module)
    monkeypatch.setattr(Tqdm, "made", [])
    return Tqdm.made


def test_a_bar_ends_at_one_or_where_the_work_does(bars, make_scene, amplitude_patch):
    with_bar = sonject.inject(amplitude_patch, make_scene(), progress=True)
    (bar,) = bars
    assert bar.n == pytest.approx(1.0) and bar.is_closed
    assert "tracing the seabed" in bar.stages
    without = sonject.inject(amplitude_patch, make_scene(), progress=False)
    assert numpy.array_equal(with_bar.image, without.image) and len(bars) == 1
    outside = make_scene(objects=[{**KEYS["objects"][0], "position": {"row": 1e6, "column": 1}}])
    with pytest.raises(sonject.SonjectError):
        sonject.inject(amplitude_patch, outside, progress=True)
    outside.close()
    with pytest.raises(ValueError, match="closed"):
        outside.context.work("sonject_trace", outside.context, outside, b"a", progress=True)
    assert len(bars) == 3 and all(bar.n < 1.0 and bar.is_closed for bar in bars[1:])


def test_there_is_no_bar_without_tqdm(monkeypatch, capfd, make_scene, amplitude_patch):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    sonject.inject(amplitude_patch, make_scene(), progress=True)
    assert capfd.readouterr() == ("", "")
