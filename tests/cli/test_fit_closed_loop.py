"""Tests fits to 10, 30 and 100 contacts of a hidden campaign against the values of its images. There are 20
tries each, or SONJECT_FIT_TRIES. Also tests a detector that learns from the fitted campaign. Takes two hours
on two cores."""

import os

import numpy
import pytest
from sklearn.linear_model import LogisticRegression
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

import fitting

TRIES = int(os.environ.get("SONJECT_FIT_TRIES", "20"))
IMAGES = 400  # they give a distribution's medians to a tenth of the tolerance


# Tolerances: sizes to a share, widths to twice that since contacts of all headings show them worse, levels to dB.
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
    most = [share, 2 * share, share, decibels, decibels]
    right = (errors < most).mean(axis=0)
    print(contacts, "contacts, right of length, width, height, level, floor:", right)
    assert all(right >= 0.9)


def test_the_same_inputs_give_the_same_campaign(sonject, tmp_path):
    fitting.make_seabeds(sonject)
    (tmp_path / "scene.yaml").write_text(fitting.SCENE)
    (tmp_path / "start.yaml").write_text(fitting.campaign(fitting.START, 40, 3, 64, 96))
    (tmp_path / "hidden.yaml").write_text(fitting.campaign(fitting.HIDDEN, 20, 11, 64, 96))
    sonject.done("campaign", "hidden.yaml", "-o", "contacts", "--quiet")
    made = []
    for _ in range(2):
        sonject.done("fit", "start.yaml", "contacts/all/coco.json", "-o", "fitted.yaml", "--quiet", timeout=600)
        made.append([(tmp_path / f"fitted.{kind}").read_bytes() for kind in ("yaml", "html", "png")])
        (tmp_path / "fitted.yaml").unlink()
    assert made[0] == made[1]


TARGETS = 2000
FALSE_ALARMS = 0.01


def share_found(training, seabed, targets, other_seabed):
    """Returns the share of targets that logistic regression finds, with FALSE_ALARMS on other seabed."""
    detector = make_pipeline(StandardScaler(), LogisticRegression(C=0.01, max_iter=2000))
    detector.fit(numpy.concatenate([training, seabed]), [1] * len(training) + [0] * len(seabed))
    threshold = numpy.quantile(detector.decision_function(other_seabed), 1 - FALSE_ALARMS)
    return (detector.decision_function(targets) > threshold).mean()


def test_a_detector_learns_from_what_is_fitted(sonject, tmp_path):
    fitting.make_seabeds(sonject, 600, 800, numbers=(1, 2, 3, 4))
    (tmp_path / "scene.yaml").write_text(fitting.SCENE)

    def make(name, draws, images, seed):
        (tmp_path / f"{name}.yaml").write_text(fitting.campaign(draws, images, seed))
        sonject.done("campaign", f"{name}.yaml", "-o", name, "--quiet", timeout=1800)

    make("start", fitting.START, IMAGES, 3)
    make("hidden", fitting.HIDDEN, IMAGES, 4)
    for contacts in (10, 100):
        make(f"contacts_{contacts}", fitting.HIDDEN, contacts, 100)
        sonject.done("fit", "start.yaml", f"contacts_{contacts}/all/coco.json", "-o", f"fitted_{contacts}.yaml",
                     "--quiet", timeout=900)
        sonject.done("campaign", f"fitted_{contacts}.yaml", "-o", f"fitted_{contacts}", "--quiet", timeout=900)
    random = numpy.random.default_rng(1)
    swaths = [tmp_path / f"seabed_{number}.tif" for number in (1, 2, 3, 4)]
    seabed = fitting.seabed_windows(swaths[:2], TARGETS, random)
    other_seabed = fitting.seabed_windows(swaths[2:], 3 * TARGETS, random)
    for new, old in zip(swaths[2:], swaths[:2]):  # new targets lie where no training image was
        new.replace(old)
    make("new", fitting.HIDDEN, TARGETS, 77)
    targets = fitting.target_windows(tmp_path / "new", random)
    assert len(targets) == TARGETS
    found = {name: share_found(fitting.target_windows(tmp_path / name, random), seabed, targets, other_seabed)
             for name in ("hidden", "start", "fitted_10", "fitted_100")}
    for name, share in found.items():
        print(f"{name}: {share:.3f} +- {1.96 * (share * (1 - share) / TARGETS) ** 0.5:.3f}", flush=True)
    assert found["fitted_100"] >= found["hidden"] - 0.02
    assert found["fitted_10"] >= found["hidden"] - 0.04
    assert found["start"] < min(found["fitted_10"], found["fitted_100"])
