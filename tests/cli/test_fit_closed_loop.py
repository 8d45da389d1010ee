"""Fits to contacts that a hidden campaign has made, against what its images show, from 10, 30 and 100
contacts: 20 tries each, SONJECT_FIT_TRIES of them. Two hours on two cores."""

import os

import numpy
import pytest

import fitting

TRIES = int(os.environ.get("SONJECT_FIT_TRIES", "20"))
IMAGES = 400  # that tell a distribution's medians, to a tenth of what is allowed


# sizes to a share, levels to so many dB
@pytest.mark.parametrize("contacts, share, decibels", [(100, 0.1, 1), (30, 0.15, 1.5), (10, 0.2, 2)])
def test_fits_find_what_made_their_contacts(sonject, tmp_path, contacts, share, decibels):
    fitting.make_seabeds(sonject, 600, 800)
    (tmp_path / "scene.yaml").write_text(fitting.SCENE)
    (tmp_path / "start.yaml").write_text(fitting.campaign(fitting.START, IMAGES, 3))
    (tmp_path / "hidden.yaml").write_text(fitting.campaign(fitting.HIDDEN, IMAGES, 4))
    for name in ("start", "hidden"):
        sonject.done("campaign", f"{name}.yaml", "-o", name, "--quiet", timeout=900)
    before, hidden = fitting.drawn(tmp_path / "start"), fitting.drawn(tmp_path / "hidden")
    errors = []
    for number in range(TRIES):
        (tmp_path / "draw.yaml").write_text(fitting.campaign(fitting.HIDDEN, contacts, 100 + number))
        sonject.done("campaign", "draw.yaml", "-o", f"contacts_{number}", "--quiet", timeout=900)
        sonject.done("fit", "start.yaml", f"contacts_{number}/all/coco.json", "-o", f"fitted_{number}.yaml",
                     "--quiet", timeout=900)
        sonject.done("campaign", f"fitted_{number}.yaml", "-o", f"fitted_{number}", "--quiet", timeout=900)
        after = fitting.drawn(tmp_path / f"fitted_{number}")
        errors.append(numpy.append(after[:3] / hidden[:3] - 1, after[3:] - hidden[3:]))
        print(contacts, number, " ".join(f"{100 * e:+.1f} %" for e in errors[-1][:3]),
              " ".join(f"{e:+.2f} dB" for e in errors[-1][3:]), flush=True)
        assert all(abs(after - hidden) < abs(before - hidden))
    errors = abs(numpy.array(errors))
    right = numpy.hstack([errors[:, :3] < share, errors[:, 3:] < decibels]).mean(axis=0)
    print(contacts, "contacts, right of length, width, height, level, floor:", right)
    assert all(right >= 0.9)
