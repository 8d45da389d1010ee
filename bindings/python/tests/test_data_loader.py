"""Tests that forked and spawned workers, and threads, make the same chips for data loaders as this process."""

import concurrent.futures
import multiprocessing
import pathlib
import sys

import numpy
import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

import data_loader  # noqa: E402

WORKERS, CHIPS = 4, 12
POOLS = {
    "forked": lambda: concurrent.futures.ProcessPoolExecutor(WORKERS, multiprocessing.get_context("fork")),
    "spawned": lambda: concurrent.futures.ProcessPoolExecutor(WORKERS, multiprocessing.get_context("spawn")),
    "threads": lambda: concurrent.futures.ThreadPoolExecutor(WORKERS),
}


@pytest.fixture(scope="module")
def chips():
    return data_loader.InjectedChips(data_loader.made_patches(), CHIPS)


@pytest.fixture(scope="module")
def made_here(chips):
    return [chips[i] for i in range(CHIPS)]


@pytest.mark.parametrize("kind", POOLS)
def test_workers_make_the_same_chips(chips, made_here, kind):
    """Forked workers go on with the context that this process has used."""
    with POOLS[kind]() as pool:
        for (image, masks), (image_here, masks_here) in zip(pool.map(chips.__getitem__, range(CHIPS)), made_here):
            assert (image == image_here).all() and (masks == masks_here).all()
    assert all(masks.any(axis=(1, 2)).all() for _, masks in made_here)
    assert len({numpy.sum(image) for image, _ in made_here}) == CHIPS
