"""Trains a small detector on a campaign's images, and tries it on those of another split.

    python3 train_detector.py CAMPAIGN.yaml [--train SPLIT] [--try SPLIT]

needs scikit-learn. Images are made in memory, the same as `sonject campaign` makes. The detector uses an image's
largest and least levels in windows of several sizes, since highlights are bright and shadows are dark. It decides
whether an image has a target, so the campaign needs images without one: `empty: 0.5`.

It shows in a minute whether the campaign teaches anything. Only real targets can show that real targets are found.
"""

import argparse

import numpy
from sklearn.ensemble import RandomForestClassifier

import sonject

WINDOWS = (2, 4), (4, 4), (8, 4), (4, 12), (8, 20)  # rows, columns


def features(image):
    """Returns largest and least mean levels in dB over the image's median, for each size of window."""
    sums = numpy.pad(numpy.abs(image).astype(float) ** 2, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
    values = []
    for rows, columns in WINDOWS:
        means = sums[rows:, columns:] - sums[:-rows, columns:] - sums[rows:, :-columns] + sums[:-rows, :-columns]
        faintest = 1e-6 * means.max() + 1e-30
        levels = 10 * numpy.log10(numpy.maximum(means, faintest) / max(numpy.median(means), faintest))
        values += [levels.max(), levels.min()]
    return values


def examples(campaign, split):
    """Returns features of a split's images, whether each has a target, and how many have clutter alone."""
    told = [each for each in map(campaign.describe, range(len(campaign))) if each.split == split]
    if not told:
        raise SystemExit(f"the campaign has no split {split!r}: see its splits")
    labels = numpy.array([each.has_target for each in told], bool)
    if labels.all() or not labels.any():
        raise SystemExit(f"split {split!r} has images of one kind only: see the campaign's empty")
    clutter = sum(each.object_count > 0 and not each.has_target for each in told)
    return numpy.array([features(campaign[each.id].image) for each in told]), labels, clutter


def area_under_curve(scores, labels):
    """Returns the area under the ROC curve (0.5: a guess, 1: perfect) and Hanley and McNeil's standard error."""
    higher = scores[labels][:, None] - scores[~labels][None]
    area = numpy.mean((higher > 0) + 0.5 * (higher == 0))
    variance = area * (1 - area)
    variance += (labels.sum() - 1) * (area / (2 - area) - area**2)
    variance += ((~labels).sum() - 1) * (2 * area**2 / (1 + area) - area**2)
    return area, numpy.sqrt(max(0.0, variance) / (labels.sum() * (~labels).sum()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign")
    parser.add_argument("--train", default="train", metavar="SPLIT")
    parser.add_argument("--try", default="val", metavar="SPLIT", dest="tried")
    options = parser.parse_args()
    campaign = sonject.Campaign(options.campaign)
    inputs, labels, _ = examples(campaign, options.train)
    unseen, truth, clutter = examples(campaign, options.tried)
    detector = RandomForestClassifier(300, min_samples_leaf=2, random_state=0).fit(inputs, labels)
    scores = detector.predict_proba(unseen)[:, 1]
    area, error = area_under_curve(scores, truth)
    found = numpy.mean(scores[truth] > numpy.quantile(scores[~truth], 0.95))
    others = (~truth).sum()
    print(f"trained on {len(labels)} images, tried on {truth.sum()} with a target and {others} without, of which {clutter} have clutter")
    print(f"area under the ROC curve {area:.3f} ± {error:.3f}; at 5 % false alarms it finds {100 * found:.0f} %")
    least = 1 - 0.05 ** (1 / others)  # at this rate, one in 20 such splits has none
    print(f"{others} images without a target cannot tell a false alarm rate below {100 * least:.1f} % from none")
    if clutter == 0:
        print("none of these has clutter: where stones lie, false alarms are more; see the campaign's clutter.alone")


if __name__ == "__main__":
    main()
