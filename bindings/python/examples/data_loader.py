"""A data set for PyTorch that makes each chip when it is asked for, in any number of workers.

    python3 data_loader.py [--chips N] [--workers N] [--start fork|spawn]

loads all chips through torch's DataLoader and prints the rate per second. Chip i is the same in
every process, thread and epoch, since it has random numbers of its own. InjectedChips needs no
torch: it suits any loader of data sets with a length and an index.
"""

import argparse
import threading
import time

import numpy

import sonject

SPACING = 0.05  # m, of rows and columns
ROWS, COLUMNS = 96, 128
SONAR = {"frequency": "100 kHz", "bandwidth": "30 kHz", "altitude": "8 m"}
GEOMETRY = {"row_spacing": SPACING, "column_spacing": SPACING, "first_slant_range": 40}
EXTENT = (ROWS * SPACING, COLUMNS * SPACING)  # m, along the track and in slant range


class InjectedChips:
    """Chips of a seabed: an image with a cylinder in it, and its highlight and shadow."""

    def __init__(self, patches, length):
        self.patches = patches
        self.length = length
        self.of_thread = threading.local()

    def __len__(self):
        return self.length

    def __getstate__(self):
        """Leaves contexts out: spawned workers make their own."""
        return {"patches": self.patches, "length": self.length}

    def __setstate__(self, state):
        self.__init__(**state)

    def context(self):
        """Returns the thread's own context, since threads that share one take turns. A forked
        worker continues with its parent's. threads=1: the workers share the processors already."""
        if not hasattr(self.of_thread, "context"):
            self.of_thread.context = sonject.Context(threads=1)
        return self.of_thread.context

    def __getitem__(self, i):
        if not 0 <= i < self.length:
            raise IndexError(i)
        random = numpy.random.default_rng(i)
        cylinder = {
            "shape": "cylinder",
            "length": random.uniform(1.4, 2.2),
            "diameter": random.uniform(0.4, 0.6),
            "heading": random.uniform(0.0, 360.0),
            "burial": {"fraction": random.uniform(0.0, 0.3)},
            "position": {"along_track": random.uniform(0.4, 0.6) * EXTENT[0],
                         "slant_range": GEOMETRY["first_slant_range"] + random.uniform(0.2, 0.5) * EXTENT[1]},
        }
        patch = self.patches[random.integers(len(self.patches))]
        with sonject.Scene(context=self.context(), sonar=SONAR, input={"geometry": GEOMETRY},
                           objects=[cylinder], injection={"seed": i}) as scene:
            result = sonject.inject(patch, scene)
        return result.image, numpy.stack([result.highlight, result.shadow])


def made_patches(count=8):
    """Makes seabeds for a try; yours are patches of measured swaths, as linear amplitudes."""
    random = numpy.random.default_rng(1)
    return random.rayleigh(size=(count, ROWS, COLUMNS)).astype(numpy.float32)


def main():
    import torch.utils.data

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--chips", type=int, default=200)
    parser.add_argument("--workers", type=int, default=4)
    parser.add_argument("--start", choices=["fork", "spawn"], default="fork")
    options = parser.parse_args()
    loader = torch.utils.data.DataLoader(
        InjectedChips(made_patches(), options.chips), batch_size=20, num_workers=options.workers,
        multiprocessing_context=options.start if options.workers else None)
    begin = time.perf_counter()
    total = sum(len(images) for images, _ in loader)
    print(f"{total} chips, {total / (time.perf_counter() - begin):.0f} a second")


if __name__ == "__main__":
    main()
