"""Results of injections."""

from __future__ import annotations

import ctypes
from functools import cached_property
from typing import Any, Optional

import numpy

from . import _interface as s
from ._classes import Box as Box
from ._classes import ContactMeasures as ContactMeasures
from ._classes import Measurement as Measurement
from ._classes import ObjectTruth as ObjectTruth
from ._classes import Statistics as Statistics
from ._parameters import Array as Array
from ._picture import picture
from ._values import initialised
from .context import Context, Handle, counted
from .enumerations import Layer, PixelKind, Status
from .errors import SonjectError
from .transfer import Transfer

_LAYER_TYPES = {
    Layer.FIELD: numpy.complex64,
    Layer.ENERGY: numpy.float32,
    Layer.VISIBILITY: numpy.float32,
    Layer.HIGHLIGHT: numpy.uint8,
    Layer.SHADOW: numpy.uint8,
    Layer.LABELS: numpy.uint8,
    Layer.INFLUENCE: numpy.uint8,
}

_PIXEL_TYPES = {
    PixelKind.AMPLITUDE: numpy.float32,
    PixelKind.COMPLEX: numpy.complex64,
    PixelKind.UINT8: numpy.uint8,
    PixelKind.UINT16: numpy.uint16,
}

# The part of the truth that notebooks show: heading, member of ObjectTruth, format.
_SHOWN = (
    ("row", "row", ".1f"),
    ("column", "column", ".1f"),
    ("slant range, m", "slant_range_m", ".2f"),
    ("target strength, dB", "target_strength_db", ".1f"),
    ("over seabed, dB", "over_seabed_db", ".1f"),
    ("highlight, pixels", "highlight_pixels", "d"),
    ("shadow, pixels", "shadow_pixels", "d"),
)


class Result(Handle):
    """The layers of an injection, each rows x columns, copied when first asked for.

    Layers that were asked for outlive close().
    """

    _noun = "result"

    def __init__(
        self,
        context: Context,
        pointer: Any,
        object_count: int,
        transfer: Optional[Transfer] = None,
    ) -> None:
        super().__init__(context, pointer)
        self._object_count = object_count
        self._transfer = transfer

    def __reduce__(self) -> Any:
        raise TypeError(
            "a Result cannot be pickled or copied: take its arrays, such as result.image and result.labels, instead"
        )

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
        """The rows and columns of every layer."""
        return self._size[:2]

    def _layer(self, layer: Layer) -> Array:
        rows, columns, kind = self._size
        if layer is Layer.IMAGE:
            pixel: Any = _PIXEL_TYPES[kind]
        else:
            pixel = _LAYER_TYPES[layer]
        array = numpy.empty((rows, columns), pixel)
        self._context.call(
            "sonject_result_layer", self, int(layer), array.ctypes.data, array.nbytes
        )
        return array

    @cached_property
    def image(self) -> Array:
        """The patch with the objects, in its type and units; grey levels if it has a transfer."""
        return self._layer(Layer.IMAGE)

    @property
    def transfer(self) -> Optional[Transfer]:
        """The function from amplitudes to the image's grey levels; None: the image is linear."""
        return self._transfer

    def _linear(self, image: Any) -> Any:
        """Returns the amplitudes or complex pixels of an image with this transfer."""
        return image if self._transfer is None else self._transfer.to_amplitude(image)

    @cached_property
    def field(self) -> Array:
        """complex64; abs(field)**2 is a backscattering cross-section in m^2."""
        return self._layer(Layer.FIELD)

    @cached_property
    def energy(self) -> Array:
        """float32; expected cross-section in m^2 of the traced scene, without speckle and noise."""
        return self._layer(Layer.ENERGY)

    @cached_property
    def visibility(self) -> Array:
        """float32; the seabed's energy that arrives, relative to a level seabed without objects.

        It is 0...1 without relief; slopes that face the sonar return more than 1.
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
        """float32 arrays, one for each number of interactions from 1 on: the part of energy from
        paths that meet so many surfaces. Empty unless the injection asked for order_energies."""
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
            structure = initialised(s.sonject_object_truth)
            self._context.call("sonject_result_object", self, index, ctypes.byref(structure))
            truths.append(ObjectTruth.from_structure(structure))
        return truths

    @cached_property
    def statistics(self) -> Statistics:
        structure = initialised(s.sonject_statistics)
        self._context.call("sonject_result_statistics", self, ctypes.byref(structure))
        return Statistics.from_structure(structure)

    def _summary(self) -> str:
        rows, columns = self.shape
        return f"{rows} x {columns} pixels, {counted(self._object_count, 'object')}"

    def _repr_html_(self) -> Optional[str]:
        """Returns the image in dB and the truth for notebooks; None once the result is closed."""
        try:
            image, truths = self._linear(self.image), self.objects
        except ValueError:
            return None
        address, (low, high) = picture(image)
        heads = "".join(f"<th>{head}</th>" for head in ("object", *(each[0] for each in _SHOWN)))
        rows = "".join(
            f"<tr><td>{index}</td>"
            + "".join(f"<td>{getattr(truth, name):{form}}</td>" for _, name, form in _SHOWN)
            + "</tr>"
            for index, truth in enumerate(truths)
        )
        return (
            f'<img src="{address}" alt="{self._summary()}">'
            f"<div>{self._summary()}; black {low:.1f} dB, white {high:.1f} dB</div>"
            + (f"<table><tr>{heads}</tr>{rows}</table>" if truths else "")
        )
