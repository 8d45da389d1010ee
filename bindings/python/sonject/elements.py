"""Time series of an array's hydrophones, for a user's own beamformer."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, fields
from typing import Any, Optional

import numpy

from . import _structures as s
from ._callbacks import Progress
from ._elements import Elements
from ._pixels import library_pixels
from ._values import PathLike, file_name, initialised, sized, whole_number
from .enumerations import SeriesForm
from .result import Array
from .scene import Scene


@dataclass(frozen=True)
class ElementLayout:
    """Where and when series are taken. An echo of delay tau has phase +2 pi f0 tau.

    elements: every default filled in; samples: of each hydrophone and ping; sound_speed_mps: of the
    delays; along_track_resolution_m: of the scene's images, whose aspects are those of a sine up to
    wavelength / (4 resolution).
    """

    elements: Elements
    samples: int
    sound_speed_mps: float
    centre_frequency_hz: float
    bandwidth_hz: float
    along_track_resolution_m: float

    @property
    def shape(self) -> tuple[int, int, int]:
        """Pings, hydrophones, samples."""
        return (self.elements.pings, self.elements.hydrophones, self.samples)

    @property
    def transmitter_m(self) -> Array:
        """Track position of the transmitter's middle at each ping."""
        pings = numpy.arange(self.elements.pings)
        origin = self.elements.first_ping_m + self.elements.ping_spacing_m * pings
        return origin + self.elements.transmitter_offset_m

    @property
    def hydrophones_m(self) -> Array:
        """Track positions of the hydrophones' middles, pings x hydrophones."""
        pings = numpy.arange(self.elements.pings)[:, None]
        numbers = numpy.arange(self.elements.hydrophones)
        origin = self.elements.first_ping_m + self.elements.ping_spacing_m * pings
        offset = self.elements.first_hydrophone_m + self.elements.hydrophone_spacing_m * numbers
        return origin + offset

    @property
    def times_s(self) -> Array:
        """Of the samples, after transmission."""
        steps = numpy.arange(self.samples) / self.elements.sampling_rate_hz
        return self.elements.first_time_s + steps


def _find_layout(scene: Scene, rows: int, columns: int) -> ElementLayout:
    layout = sized(s.sonject_element_layout)
    scene.context.call(
        "sonject_elements_describe", scene.context, scene, rows, columns, ctypes.byref(layout)
    )
    given = {entry.name: getattr(layout.elements, entry.name) for entry in fields(Elements)}
    values = {
        entry.name: getattr(layout, entry.name)
        for entry in fields(ElementLayout)
        if entry.name != "elements"
    }
    return ElementLayout(elements=Elements(**given), **values)


def element_layout(scene: Scene, shape: tuple[int, int] = (0, 0)) -> ElementLayout:
    """What element_series gives for a patch of this shape, rows x columns.

    (0, 0): for the patch that the scene's input, Uniform or Synthetic, makes.
    """
    largest = 2**31
    rows, columns = (whole_number("shape", size, largest) for size in shape)
    return _find_layout(scene, rows, columns)


def element_series(patch: Any, scene: Scene, progress: Optional[Progress] = None) -> Array:
    """What each hydrophone of the scene's array hears: pings x hydrophones x samples.

    complex64, or float32 in pass band; over the source's pressure at 1 m, or in Pa where the array
    has a source_level_db. Heard is what inject draws: targets and, where it resynthesises, the
    seabed; in composite mode the seabed is the measured patch, which has no element data. patch,
    progress, and what is raised: as for inject.
    """
    pixels = None
    array = None  # must live until the call is over: pixels points into it
    if patch is not None:
        pixels, array = library_pixels(patch)
    layout = _find_layout(scene, *((0, 0) if array is None else array.shape))
    is_complex = layout.elements.form == SeriesForm.BASEBAND
    series = numpy.empty(layout.shape, numpy.complex64 if is_complex else numpy.float32)
    scene.context.work(
        "sonject_element_series",
        scene.context,
        scene,
        None if pixels is None else ctypes.byref(pixels),
        progress=progress,
        outputs=[series.ctypes.data_as(ctypes.POINTER(ctypes.c_float)), series.nbytes],
    )
    return series


def run_elements(
    scene: Scene,
    folder: PathLike,
    progress: Optional[Progress] = None,
    *,
    overwrites: bool = False,
) -> None:
    """Reads the scene's input, and writes series.npy and elements.json into folder.

    Series of other inputs there are refused unless overwrites is true.
    """
    params = initialised(s.sonject_run_params)
    params.folder = file_name("folder", folder)
    params.overwrites = int(bool(overwrites))
    scene.context.work(
        "sonject_elements_run", scene.context, scene, ctypes.byref(params), progress=progress
    )
