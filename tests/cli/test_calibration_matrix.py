"""Tests calibrations of made swaths: all curves x 1 to 4 looks x three ceilings x three noise floors, with speckle
1.5 pixels wide, and of 1 to 3 looks with speckle 3 pixels wide. In 95 % of the cases estimates are within three
standard errors, and these are small. Takes ten minutes."""

import json

import numpy
import pytest

from made_swaths import KINDS, Made, deviations

FLOORS = {0.7: -20.0, 0.9: -25.0, 1.0: -30.0}


@pytest.mark.parametrize("width, most_looks", ((1.5, 4), (3.0, 3)))
@pytest.mark.parametrize("kind", KINDS)
def test_curves_looks_ceilings_and_floors(kind, width, most_looks, sonject, tmp_path):
    found = []
    for looks in range(1, most_looks + 1):
        for share in (0.7, 0.9, 1.0):
            for turn in range(3):
                floor = list(FLOORS.values())[(list(FLOORS).index(share) + turn) % 3]
                seed = 100 * turn + 10 * looks + round(10 * share)
                made = Made(kind, looks, share, floor, seed, width=width)
                numpy.save(tmp_path / "made.npy", made.numbers)
                answer = sonject("calibrate", "--json", "made.npy")
                assert answer.returncode == 0, answer.stderr
                measured = json.loads(answer.stdout)["measured"]
                case = (looks, share, floor)
                assert measured["transfer"]["kind"] == kind, (case, measured["transfer"])
                assert measured["full_scale"]["value"] == made.ceiling, case
                assert measured["clipped"]["value"] == pytest.approx(made.clipped, rel=1e-3), case
                found += [(case, name, *deviation)
                          for name, deviation in deviations(made, measured).items()]
    names = {name for _, name, _, _ in found}
    for name in names:
        of_it = [entry for entry in found if entry[1] == name]
        outside = [entry for entry in of_it if abs(entry[2]) > 3]
        assert len(outside) <= 0.05 * len(of_it), outside
        wide = [entry for entry in of_it if entry[3] > 1]
        assert len(wide) <= 0.05 * len(of_it), wide
