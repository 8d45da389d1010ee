"""Transfer functions between amplitudes and grey levels."""

from __future__ import annotations

import ctypes
from typing import Any, Dict, Mapping, Union, get_args, get_type_hints

import numpy

from ._parameters import Array
from ._values import STORED_KINDS, keys_text, library_pixels, scene_value
from .context import default_context
from .keys import InputTransfer


class Transfer(Dict[str, Any]):
    """The function from amplitudes to the numbers of an image: keys of input.transfer of scenes.

    >>> curve = Transfer("{kind: decibel, parameter: 0.378}")
    >>> amplitudes = curve.to_amplitude(grey_levels)

    At full scale the amplitude is 1: the largest number of uint8 or uint16, or 1.0 of float32.
    """

    def __init__(self, keys: Union[str, Mapping[str, Any]]) -> None:
        if isinstance(keys, str):
            keys = scene_value("input.transfer", keys)
        if not isinstance(keys, Mapping):
            kinds = ", ".join(get_args(get_type_hints(InputTransfer)["kind"]))
            raise TypeError("a transfer function is a dictionary of keys or its text, such as "
                            f'"{{kind: decibel, parameter: 0.5}}", of a kind {kinds}; not {keys!r}')
        super().__init__(keys)
        self.to_amplitude(numpy.zeros(1, numpy.uint8))  # refuses unknown keys

    def to_amplitude(self, stored: Any) -> Array:
        """Returns linear amplitudes, float32, of grey levels: an array of uint8, uint16 or float32."""
        return _converted(stored, self, numpy.dtype(numpy.float32), None)

    def from_amplitude(self, amplitudes: Any, dtype: Any = numpy.uint8) -> Array:
        """Returns grey levels (uint8, uint16 or float32) of linear amplitudes. As in a run, whole
        numbers are rounded and limited to full scale."""
        kind = numpy.dtype(dtype)
        if kind not in STORED_KINDS:
            raise TypeError(f"grey levels are uint8, uint16 or float32, not {kind}")
        if numpy.asarray(amplitudes).dtype.kind != "f":
            raise TypeError("amplitudes are floating point numbers, "
                            f"not {numpy.asarray(amplitudes).dtype}")
        return _converted(amplitudes, None, kind, self)


def _converted(numbers: Any, old: Any, kind: Any, new: Any) -> Array:
    array = numpy.asanyarray(numbers)
    pixels, kept = library_pixels(array if array.ndim == 2 else array.reshape(1, -1), old)
    made: Array = numpy.empty(array.shape, kind)
    context = default_context()
    context.call("sonject_pixels_convert", context, ctypes.byref(pixels), int(STORED_KINDS[kind]),
                 keys_text("transfer", new), made.ctypes.data, made.nbytes)
    del kept
    return made
