"""What an injection gives back."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy
import numpy.typing

from . import _structures as s
from ._handle import Handle
from ._values import sized
from .context import Context
from .enumerations import Layer, PixelKind, Status
from .errors import SonjectError

Array = numpy.typing.NDArray[Any]

_LAYER_TYPES = {
    Layer.FIELD: numpy.complex64,
    Layer.ENERGY: numpy.float32,
    Layer.VISIBILITY: numpy.float32,
    Layer.HIGHLIGHT: numpy.uint8,
    Layer.SHADOW: numpy.uint8,
    Layer.LABELS: numpy.uint8,
    Layer.INFLUENCE: numpy.uint8,
}


@dataclass(frozen=True)
class Box:
    """Whole pixels of the patch; rows = columns = 0: empty."""

    first_row: int
    first_column: int
    rows: int
    columns: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """To cut the box out of a layer: ``result.image[box.slices]``."""
        return (
            slice(self.first_row, self.first_row + self.rows),
            slice(self.first_column, self.first_column + self.columns),
        )


@dataclass(frozen=True)
class ObjectTruth:
    """Where an object came to lie in the patch and how it shows.

    is_visible: some pixel is its own, or it casts a shadow; *_is_cut: touches the patch's edge;
    row, column: of its centre, in patch pixels; slant_range_m: apparent; height_m: of the centre
    over the seabed; target_strength_db: of its echo's peak, wherever pixels lie, re 1 m^2, -inf where
    nothing of it is in view; contrasts and lengths: as ContactMeasures, of
    expected energies; burial_m: depth of the lowest
    point; grazing_rad: of the sound that comes straight to the centre; transmission_loss_db: one
    way, from 1 m off the sonar; level_kind: LevelKind that was asked for; level_gain_db: by which
    its echo was scaled; over_seabed_db: that peak over the seabed there;
    seabed_strength_db: assumed, of an m^2 at the centre's grazing angle; highlight_visible: share
    of its energy where it dominates all else; shadow_visible: share of its shadow that no other
    object's highlight fills; overall sizes: along its nose, its own y and z.
    """

    is_visible: bool
    highlight_is_cut: bool
    shadow_is_cut: bool
    row: float
    column: float
    along_track_m: float
    slant_range_m: float
    ground_range_m: float
    height_m: float
    highlight: Box
    shadow: Box
    both: Box
    highlight_pixels: int
    shadow_pixels: int
    target_strength_db: float
    highlight_contrast_db: float
    shadow_contrast_db: float
    burial_m: float
    grazing_rad: float
    transmission_loss_db: float
    level_kind: int
    level_gain_db: float
    over_seabed_db: float
    seabed_strength_db: float
    highlight_visible: float
    shadow_visible: float
    overall_length_m: float
    overall_width_m: float
    overall_height_m: float
    highlight_along_m: float
    highlight_range_m: float
    shadow_along_m: float
    shadow_range_m: float
    gap_range_m: float
    dim_range_m: float


@dataclass(frozen=True)
class Statistics:
    """Counts, times in seconds, and (resynthesise only, otherwise NaN) output against input.

    noise_floor_db: that was used, over the local mean seabed energy; contrasts: intensity standard
    deviation over mean; histogram_distance: Kolmogorov-Smirnov; correlation: of the intensities;
    seabed_...: of the measured image around the objects, NaN where it says nothing, shape of the K
    distribution; then what was used for what was put in: resolutions, looks, and the amplitude that
    cuts highlights.
    """

    pings: int
    rays: int
    ray_queries: int
    impulses: int
    trace_s: float
    form_s: float
    inject_s: float
    noise_floor_db: float
    input_clipped: int
    output_clipped: int
    changed_pixels: int
    level_change_db: float
    input_contrast: float
    output_contrast: float
    histogram_distance: float
    correlation: float
    seabed_amplitude_contrast: float
    seabed_shape: float
    seabed_looks: float
    seabed_row_correlation: float
    seabed_column_correlation: float
    along_track_resolution_m: float
    range_resolution_m: float
    looks: float
    saturation_amplitude: float


@dataclass(frozen=True)
class Measurement:
    """What an image says: untouched seabed (NaN: nothing), and the seam of an injection.

    Contrasts: standard deviation over mean; looks: averaged in a pixel; shape: of the K
    distribution; correlations: of speckle's intensity between neighbours; lengths: where the
    intensity's correlation falls to 1/e; seam: how well a classifier tells background that the
    injection changed from untouched, 0.5: not at all, 1: always (NaN: not asked, or too little was
    changed), with its standard error and the number of patches of either kind.
    """

    amplitude_contrast: float
    intensity_contrast: float
    looks: float
    shape: float
    row_correlation: float
    column_correlation: float
    row_length_pixels: float
    column_length_pixels: float
    seam: float
    seam_error: float
    seam_patches: int
    background_patches: int


@dataclass(frozen=True)
class ContactMeasures:
    """Lengths and levels of a contact's highlight and shadow, NaN where there is none or it is not
    known. along: along the track; range: slant range, the shadow's length; axis: of the highlight's
    energy; gap: what is lit between highlight and shadow, such as the top of a thick target; dim:
    the first part of the shadow if it is brighter than the rest; error: standard, by speckle alone;
    levels in dB of squared amplitude; the rest is of the seabed, as in Measurement. is_cut:
    highlight or shadow reaches the edge of the image or of the box, which is what was measured."""

    highlight: Box
    shadow: Box
    highlight_along_pixels: float
    highlight_range_pixels: float
    shadow_along_pixels: float
    shadow_range_pixels: float
    highlight_along_m: float
    highlight_range_m: float
    shadow_along_m: float
    shadow_range_m: float
    axis_length_m: float
    axis_width_m: float
    axis_rad: float
    highlight_db: float
    shadow_db: float
    seabed_db: float
    highlight_contrast_db: float
    shadow_contrast_db: float
    seabed_shape: float
    seabed_looks: float
    row_length_pixels: float
    column_length_pixels: float
    gap_range_pixels: float
    gap_range_m: float
    dim_range_pixels: float
    dim_range_m: float
    highlight_along_error_pixels: float
    highlight_range_error_pixels: float
    shadow_along_error_pixels: float
    shadow_range_error_pixels: float
    gap_range_error_pixels: float
    dim_range_error_pixels: float
    is_cut: bool
    box: Box


def _copied(kind: Any, structure: ctypes.Structure) -> dict[str, Any]:
    return {entry.name: getattr(structure, entry.name) for entry in fields(kind)}


def _truth(structure: s.sonject_object_truth) -> ObjectTruth:
    values = _copied(ObjectTruth, structure)
    for name in ("is_visible", "highlight_is_cut", "shadow_is_cut"):
        values[name] = bool(values[name])
    for name in ("highlight", "shadow", "both"):
        values[name] = Box(**_copied(Box, values[name]))
    return ObjectTruth(**values)


class Result(Handle):
    """The layers of an injection, each rows x columns, copied when first asked for.

    Layers that were asked for outlive close().
    """

    _noun = "result"

    def __init__(self, context: Context, pointer: Any, object_count: int) -> None:
        super().__init__(context, pointer)
        self._object_count = object_count

    @cached_property
    def _size(self) -> tuple[int, int, PixelKind]:
        rows, columns, kind = ctypes.c_uint64(), ctypes.c_uint64(), ctypes.c_uint32()
        self._context.call(
            "sonject_result_size",
            self,
            ctypes.byref(rows),
            ctypes.byref(columns),
            ctypes.byref(kind),
        )
        return rows.value, columns.value, PixelKind(kind.value)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of every layer."""
        return self._size[:2]

    def _layer(self, layer: Layer) -> Array:
        rows, columns, kind = self._size
        if layer is Layer.IMAGE:
            pixel: Any = numpy.complex64 if kind is PixelKind.COMPLEX else numpy.float32
        else:
            pixel = _LAYER_TYPES[layer]
        array = numpy.empty((rows, columns), pixel)
        self._context.call(
            "sonject_result_layer", self, int(layer), array.ctypes.data, array.nbytes
        )
        return array

    @cached_property
    def image(self) -> Array:
        """The patch with the objects: float32 or complex64, kind and units of the input."""
        return self._layer(Layer.IMAGE)

    @cached_property
    def field(self) -> Array:
        """complex64; abs(field)**2 is a backscattering cross-section in m^2."""
        return self._layer(Layer.FIELD)

    @cached_property
    def energy(self) -> Array:
        """float32; expected cross-section in m^2 of what was traced, no speckle, no noise."""
        return self._layer(Layer.ENERGY)

    @cached_property
    def visibility(self) -> Array:
        """float32; the seabed's energy that arrives, over that of a level seabed without objects.

        0...1 without relief; slopes that face the sonar return more than 1.
        """
        return self._layer(Layer.VISIBILITY)

    @cached_property
    def highlight(self) -> Array:
        """uint8; 255 where an object's echo dominates."""
        return self._layer(Layer.HIGHLIGHT)

    @cached_property
    def shadow(self) -> Array:
        """uint8; 255 where less than half of the seabed's energy arrives."""
        return self._layer(Layer.SHADOW)

    @cached_property
    def labels(self) -> Array:
        """uint8; object number + 1 of highlights and shadows, 0 elsewhere."""
        return self._layer(Layer.LABELS)

    @cached_property
    def influence(self) -> Array:
        """uint8; 255 where the image was changed."""
        return self._layer(Layer.INFLUENCE)

    @cached_property
    def order_energies(self) -> list[Array]:
        """float32, one for each number of interactions from 1 on: the part of energy that paths
        have which meet so many surfaces. Empty unless the injection asked for order_energies."""
        energies: list[Array] = []
        while True:
            energy = numpy.empty(self.shape, numpy.float32)
            order = len(energies) + 1
            try:
                self._context.call(
                    "sonject_result_order_energy", self, order, energy.ctypes.data, energy.nbytes
                )
            except SonjectError as error:
                if error.status is not Status.ERROR_ARGUMENT:
                    raise
                return energies
            energies.append(energy)

    @cached_property
    def objects(self) -> list[ObjectTruth]:
        """The truth of each object, in the scene's order."""
        truths = []
        for index in range(self._object_count):
            structure = sized(s.sonject_object_truth)
            self._context.call(
                "sonject_result_object", self, index, ctypes.byref(structure)
            )
            truths.append(_truth(structure))
        return truths

    @cached_property
    def statistics(self) -> Statistics:
        structure = sized(s.sonject_statistics)
        self._context.call("sonject_result_statistics", self, ctypes.byref(structure))
        return Statistics(**_copied(Statistics, structure))
