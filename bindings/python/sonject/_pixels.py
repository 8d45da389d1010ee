"""NumPy arrays as the library's pixels."""

from __future__ import annotations

from typing import Any

import numpy

from . import _structures as s
from ._values import sized
from .enumerations import PixelKind

_KINDS = {
    numpy.dtype(numpy.float32): PixelKind.AMPLITUDE,
    numpy.dtype(numpy.complex64): PixelKind.COMPLEX,
}


def _single_precision(array: Any) -> Any:
    """The same numbers as float32 or complex64; array itself if it has one of these types."""
    if array.dtype in _KINDS:
        return array
    if array.dtype.kind not in "fc":
        raise TypeError(
            f"a patch of {array.dtype} is refused: it must hold linear amplitudes or complex "
            "pixels; undo the image's transfer function and convert it, "
            "for instance patch.astype(numpy.float32) / 255"
        )
    target = numpy.float32 if array.dtype.kind == "f" else numpy.complex64
    with numpy.errstate(over="ignore"):
        converted = array.astype(target)
    if numpy.any(numpy.isfinite(array) & ~numpy.isfinite(converted)):
        raise ValueError(f"the patch of {array.dtype} has numbers beyond single precision")
    return converted


def _is_direct(array: Any) -> bool:
    """Whether the library can read the array where it lies."""
    rows, columns = array.shape
    row_step, column_step = array.strides
    size = array.dtype.itemsize
    if not array.flags.aligned or (columns > 1 and column_step != size):
        return False
    return bool(rows == 1 or (row_step >= columns * size and row_step % 4 == 0))


def library_pixels(patch: Any) -> tuple[s.sonject_pixels, Any]:
    """The structure for patch and the array that its pointer points into, to be kept meanwhile.

    float32 and complex64 arrays with contiguous columns are not copied, whatever their row stride.
    """
    if isinstance(patch, numpy.ma.MaskedArray):
        raise TypeError("a masked patch is refused: its mask would be lost")
    array = numpy.asarray(patch)
    if array.ndim != 2 or 0 in array.shape:
        raise ValueError(f"a patch has rows and columns, not the shape {array.shape}")
    array = _single_precision(array)
    if not _is_direct(array):
        array = numpy.array(array, order="C", copy=True)
    pixels = sized(s.sonject_pixels)
    pixels.kind = _KINDS[array.dtype]
    pixels.rows, pixels.columns = array.shape
    pixels.row_stride = array.strides[0] if array.shape[0] > 1 else 0
    pixels.data = array.ctypes.data
    return pixels, array
