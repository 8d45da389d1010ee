"""The base classes of C structures' classes, and members that some have beside their fields."""

import ctypes
from dataclasses import fields
from typing import Any, Type, TypeVar

import numpy
import numpy.typing

from ._values import text

Self = TypeVar("Self", bound="Answer")
Array = numpy.typing.NDArray[Any]


def _from_c(kind: Any, value: Any) -> Any:
    """Converts a member of a structure to a field of this type."""
    if isinstance(value, bytes):
        return text(value)
    if isinstance(value, ctypes.Structure):
        return kind.from_structure(value)
    return bool(value) if kind is bool else value


class Answer:
    """A C structure of the library; fields have the names of the structure's members."""

    @classmethod
    def from_structure(cls: Type[Self], structure: Any) -> Self:
        entries = fields(cls)  # type: ignore[arg-type]  # all derived classes are dataclasses
        return cls(**{each.name: _from_c(each.type, getattr(structure, each.name)) for each in entries})


class BoxBase(Answer):
    @property
    def slices(self: Any) -> tuple[slice, slice]:
        """The slices that cut the box out of a layer: ``result.image[box.slices]``."""
        return (
            slice(self.first_row, self.first_row + self.rows),
            slice(self.first_column, self.first_column + self.columns),
        )


class ElementLayoutBase(Answer):
    @property
    def shape(self: Any) -> tuple[int, int, int]:
        """The numbers of pings, hydrophones and samples."""
        return (self.elements.pings, self.elements.hydrophones, self.samples)

    @property
    def _origins_m(self: Any) -> Array:
        pings = numpy.arange(self.elements.pings)
        return numpy.asarray(self.elements.first_ping_m + self.elements.ping_spacing_m * pings)

    @property
    def transmitter_m(self: Any) -> Array:
        """Track position of the transmitter's middle at each ping."""
        return numpy.asarray(self._origins_m + self.elements.transmitter_offset_m)

    @property
    def hydrophones_m(self: Any) -> Array:
        """Track positions of the hydrophones' middles, pings x hydrophones."""
        numbers = numpy.arange(self.elements.hydrophones)
        offset = self.elements.first_hydrophone_m + self.elements.hydrophone_spacing_m * numbers
        return numpy.asarray(self._origins_m[:, None] + offset)

    @property
    def times_s(self: Any) -> Array:
        """The times of the samples after transmission."""
        steps = numpy.arange(self.samples) / self.elements.sampling_rate_hz
        return numpy.asarray(self.elements.first_time_s + steps)
