"""Tests of the data set in PyTorch's own loader."""

import torch.utils.data

import pytest

from test_data_loader import CHIPS, WORKERS, chips, data_loader, made_here  # noqa: F401


@pytest.mark.parametrize("start", ["fork", "spawn", None])
def test_batches_are_the_chips_in_order(chips, made_here, start):  # noqa: F811
    loader = torch.utils.data.DataLoader(chips, batch_size=5, num_workers=WORKERS if start else 0,
                                         multiprocessing_context=start)
    for _ in range(2):
        loaded = [image for images, _ in loader for image in images]
        assert len(loaded) == CHIPS
        for image, (image_here, _) in zip(loaded, made_here):
            assert (image.numpy() == image_here).all()


def test_the_example_says_how_many_it_made(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["data_loader.py", "--chips", "8", "--workers", "2"])
    data_loader.main()
    assert capsys.readouterr().out.startswith("8 chips, ")
