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
from measured_images import measured

TRIES = int(os.environ.get("SONJECT_FIT_TRIES", "20"))
IMAGES = 400  # they give a distribution's medians to a tenth of the tolerance


# Tolerances: lengths and heights to a share, widths to another since contacts of all headings show them worse, dB.
TOLERANCES = {100: (0.1, 0.15, 1), 30: (0.15, 0.3, 1.5), 10: (0.2, 0.4, 2)}


def check_fits(sonject, folder, contacts, **of_campaign):
    """Fits to contacts of the hidden campaign, which has a scene.yaml and its swaths in the folder."""
    def make(name, draws, images, seed):
        (folder / f"{name}.yaml").write_text(fitting.campaign(draws, images, seed, **of_campaign))
        sonject.done("campaign", f"{name}.yaml", "-o", name, "--quiet", timeout=900)

    make("start", fitting.START, IMAGES, 3)
    make("hidden", fitting.HIDDEN, IMAGES, 4)
    before, hidden = fitting.drawn(folder / "start"), fitting.drawn(folder / "hidden")
    errors = []
    for number in range(TRIES):
        make(f"contacts_{number}", fitting.HIDDEN, contacts, 100 + number)
        sonject.done("fit", "start.yaml", f"contacts_{number}/all/coco.json", "-o", f"fitted_{number}.yaml",
                     "--quiet", timeout=900)
        sonject.done("campaign", f"fitted_{number}.yaml", "-o", f"fitted_{number}", "--quiet", timeout=900)
        after = fitting.drawn(folder / f"fitted_{number}")
        errors.append(numpy.append(after[:3] / hidden[:3] - 1, after[3:] - hidden[3:]))
        print(contacts, number, " ".join(f"{100 * e:+.1f} %" for e in errors[-1][:3]),
              " ".join(f"{e:+.2f} dB" for e in errors[-1][3:]), flush=True)
        assert all(abs(after - hidden) < abs(before - hidden))
    share, of_width, decibels = TOLERANCES[contacts]
    most = [share, of_width, share, decibels, decibels]
    right = (abs(numpy.array(errors)) < most).mean(axis=0)
    print(contacts, "contacts, right of length, width, height, level, floor:", right)
    assert all(right >= 0.9)


@pytest.mark.parametrize("contacts", TOLERANCES)
def test_fits_find_what_made_their_contacts(sonject, tmp_path, contacts):
    fitting.make_seabeds(sonject, 600, 800)
    (tmp_path / "scene.yaml").write_text(fitting.SCENE)
    check_fits(sonject, tmp_path, contacts)


MEASURED_SCENE = """\
sonject: 1
input:
  geometry: {row_spacing: 2.5 cm, column_spacing: 2.5 cm, first_slant_range: 37.5 m}
  transfer: {kind: schlick, parameter: 3}
sonar: {frequency: 300 kHz, bandwidth: 20 kHz, altitude: 10 m, resolution: 5 cm, response: taylor}
"""


def test_fits_find_them_in_a_measured_picture(sonject, tmp_path):
    """The picture's ceiling cuts the highlights. The start's levels lie far above it."""
    (tmp_path / "seabed.png").symlink_to(measured("sassed/sassed44_1001x1001_original.png"))
    (tmp_path / "scene.yaml").write_text(MEASURED_SCENE)
    check_fits(sonject, tmp_path, 100, swaths=["seabed.png"])


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
