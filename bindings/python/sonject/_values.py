"""Python values as C fields, refusing what ctypes would silently cut or wrap; arrays as pixels."""

from __future__ import annotations

import ctypes
import enum
import json
import math
import numbers
import operator
import os
from typing import Any, Iterable, Mapping, Optional, Tuple, Type, TypeVar, Union

import numpy

from . import _interface as s
from .enumerations import PixelKind

PathLike = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Overrides = Union[Iterable[str], Mapping[str, Any]]
AnyStructure = TypeVar("AnyStructure", bound=ctypes.Structure)
AnyEnum = TypeVar("AnyEnum", bound=enum.IntEnum)

_LARGEST: dict[Any, int] = {ctypes.c_uint32: 2**32 - 1, ctypes.c_uint64: 2**64 - 1}


def whole_number(name: str, value: Any, largest: int) -> int:
    """Returns value as an int within 0...largest."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not 0 <= number <= largest:
        raise ValueError(f"{name} must lie within 0...{largest}, not {number}")
    return number


# Endings of names: a key of scenes that takes the same units, and an example.
_UNITS = {
    "_m": ("sonar.altitude", "25 cm"),
    "_hz": ("sonar.frequency", "100 kHz"),
    "_s": ("elements.first_time", "20 ms"),
    "_celsius": ("medium.absorption.temperature", "12 C"),
    "decibels": ("injection.noise_floor", "-20 dB"),
}


def real_number(name: str, value: Any) -> float:
    """Returns value as a float, a text by its unit. The library checks its range."""
    key, example = next((_UNITS[end] for end in _UNITS if name.endswith(end)), (None, None))
    number = scene_value(key, key_text(name, value)) if key and isinstance(value, str) else value
    if not isinstance(number, numbers.Real):
        text_too = f" or a text such as {example!r}" if example else ""
        raise TypeError(f"{name} must be a number{text_too}, not {value!r}")
    return float(number)


def scene_value(key: str, content: str) -> Any:
    """Returns the value that a scene reads from a text for a key; a text if it is no quantity."""
    from .context import default_context  # both modules import this one
    from .scene import Scene

    context = default_context()
    pointer = context.make(s.sonject_scene, "sonject_scene_create", context)
    with Scene._adopt(context, pointer) as scene:
        context.call("sonject_scene_set", scene, plain_text("key", key), plain_text(key, content))
        return scene[key]


def real_numbers(name: str, values: Any) -> Any:
    """Returns values, an array or a sequence of numbers in one row, as an array of doubles."""
    if isinstance(values, numpy.ma.MaskedArray):
        raise TypeError(f"{name} must not be masked: its mask would be lost")
    array = numpy.asarray(values)
    if array.size > 0 and array.dtype.kind not in "iuf":
        raise TypeError(f"{name} must be numbers, not {array.dtype}")
    if array.ndim != 1:
        raise ValueError(f"{name} must be in one row, not of shape {array.shape}")
    return numpy.ascontiguousarray(array, dtype=numpy.float64)


def choice(name: str, kind: Type[AnyEnum], value: Any) -> AnyEnum:
    """Returns value as a member of kind; a member's name in any case will do."""
    if isinstance(value, str) and value.upper() in kind.__members__:
        return kind[value.upper()]
    if not isinstance(value, str):
        try:
            return kind(value)
        except ValueError:
            pass
    names = ", ".join(member.lower() for member in kind.__members__)
    raise ValueError(f"{name} must be one of {names}, not {value!r}")


def text(line: Optional[bytes]) -> str:
    """Decodes a text of the library; damaged UTF-8 does not hide the rest of a message."""
    return (line or b"").decode("utf-8", "replace")


def plain_text(name: str, value: Any) -> bytes:
    """Returns value in UTF-8. A NUL, which would end the text early, is refused."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text, not {value!r}")
    if "\0" in value:
        raise ValueError(f"{name} contains a NUL: {value!r}")
    return value.encode("utf-8")


def file_name(name: str, value: Any) -> bytes:
    """Returns a path in the file system's encoding."""
    try:
        encoded = os.fsencode(value)
    except TypeError:
        raise TypeError(f"{name} must be a path, not {value!r}") from None
    if b"\0" in encoded:
        raise ValueError(f"{name} contains a NUL: {value!r}")
    return encoded


def absolute_file_name(name: str, value: Any) -> bytes:
    """Returns a path that means the same file after a change of the working directory."""
    return os.path.abspath(file_name(name, value))


def optional_file_name(name: str, value: Any) -> Optional[bytes]:
    return None if value is None else file_name(name, value)


def key_text(name: str, value: Any) -> str:
    """Returns the value of a scene's key as JSON, which is YAML, too."""
    return json.dumps(_plain(name, value), ensure_ascii=False, allow_nan=False)


def keys_text(name: str, value: Any) -> Optional[bytes]:
    """Returns keys of a scene, a mapping or their text, for a call; None for None."""
    if value is None:
        return None
    return plain_text(name, value if isinstance(value, str) else key_text(name, value))


def _plain(name: str, value: Any) -> Any:
    """Returns value as dictionaries, lists, texts and numbers alone."""
    if isinstance(value, numpy.generic) or isinstance(value, numpy.ndarray):
        value = value.tolist()
    if isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, numbers.Real):
        return float(value) if math.isfinite(value) else str(float(value))
    if isinstance(value, os.PathLike):
        return os.fsdecode(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(f"{name}.{key}", each) for key, each in value.items()}
    if isinstance(value, Iterable) and not isinstance(value, bytes):
        return [_plain(f"{name}[{index}]", each) for index, each in enumerate(value)]
    raise TypeError(f"{name} must be of texts, numbers, lists and dictionaries, not {value!r}")


def initialised(kind: Type[AnyStructure]) -> AnyStructure:
    """Returns a structure with its size set and zeros otherwise, which stand for defaults."""
    structure = kind()
    if hasattr(structure, "struct_size"):
        structure.struct_size = ctypes.sizeof(kind)
    return structure


def fill(structure: ctypes.Structure, values: Mapping[str, Any]) -> None:
    """Assigns each named value after checking it for the field's type."""
    types = {field[0]: field[1] for field in structure._fields_}
    for name, value in values.items():
        kind = types[name]
        if kind is ctypes.c_double:
            value = real_number(name, value)
        elif kind in _LARGEST:
            value = whole_number(name, value, _LARGEST[kind])
        setattr(structure, name, value)


def filled(kind: Type[AnyStructure], /, **values: Any) -> AnyStructure:
    """Returns a structure with these values and the library's defaults otherwise."""
    structure = initialised(kind)
    fill(structure, values)
    return structure


def given(**values: Any) -> dict[str, Any]:
    """Returns the values that are not None."""
    return {name: value for name, value in values.items() if value is not None}


def shard_values(shard: Tuple[int, int]) -> dict[str, int]:
    """Returns shard (i, K) as members of a structure. The library checks that i is one of K."""
    index, count = (whole_number("shard", number, 2**32 - 1) for number in shard)
    return {"shard_index": index, "shard_count": count}


def override_texts(overrides: Overrides) -> Any:
    """Returns an array of "key.path=value" texts, from such texts or from a mapping of key paths."""
    if isinstance(overrides, str):
        raise TypeError("overrides must be a list of texts or a mapping, not one text")
    if isinstance(overrides, Mapping):
        overrides = [f"{key}={value if isinstance(value, str) else key_text(key, value)}" for key, value in overrides.items()]
    texts = [file_name("override", each) for each in overrides]
    return (ctypes.c_char_p * len(texts))(*texts)


# Types of linear pixels, and of pixels that may have a transfer function.
_KINDS = {
    numpy.dtype(numpy.float32): PixelKind.AMPLITUDE,
    numpy.dtype(numpy.complex64): PixelKind.COMPLEX,
}
STORED_KINDS = {
    numpy.dtype(numpy.uint8): PixelKind.UINT8,
    numpy.dtype(numpy.uint16): PixelKind.UINT16,
    numpy.dtype(numpy.float32): PixelKind.AMPLITUDE,
}


def _single_precision(array: Any) -> Any:
    """Returns the numbers as float32 or complex64; array itself if it has one of these types."""
    if array.dtype in _KINDS:
        return array
    if array.dtype.kind not in "fc":
        raise TypeError(
            f"a patch of {array.dtype} is refused without its transfer function: say how grey levels "
            'came from amplitudes, for instance transfer="{kind: decibel, parameter: 0.5}"; a scene\'s '
            'input.transfer, like that of a calibration, is that of its file alone: pass '
            'transfer=scene["input.transfer"]'
        )
    target = numpy.float32 if array.dtype.kind == "f" else numpy.complex64
    with numpy.errstate(over="ignore"):
        converted = array.astype(target)
    if numpy.any(numpy.isfinite(array) & ~numpy.isfinite(converted)):
        raise ValueError(f"the patch of {array.dtype} has numbers beyond single precision")
    return converted


def _stored(array: Any) -> Any:
    """Returns the numbers in a type that has a transfer function."""
    if array.dtype.kind == "f":
        return _single_precision(array)
    if array.dtype.newbyteorder("=") in STORED_KINDS:
        return array.astype(array.dtype.newbyteorder("="), copy=False)
    raise TypeError(f"grey levels are uint8, uint16 or float32, not {array.dtype}")


def _is_direct(array: Any) -> bool:
    """Returns whether the library can read the array without a copy."""
    rows, columns = array.shape
    row_step, column_step = array.strides
    size = array.dtype.itemsize
    if not array.flags.aligned or (columns > 1 and column_step != size):
        return False
    return bool(rows == 1 or (row_step >= columns * size and row_step % min(size, 4) == 0))


def library_pixels(patch: Any, transfer: Any = None) -> tuple[s.sonject_pixels, Any]:
    """Returns the structure for patch, and the array that its pointer points into and needs.

    Arrays of the library's types with contiguous columns are not copied, whatever their row stride.
    """
    if isinstance(patch, numpy.ma.MaskedArray):
        raise TypeError("a masked patch is refused: its mask would be lost")
    if isinstance(patch, (str, os.PathLike)):
        raise TypeError(
            f"a patch is an array, not the file {os.fspath(patch)}: read its pixels first, or take "
            "what works on files, such as run and calibrate"
        )
    array = numpy.asarray(patch)
    if array.ndim != 2 or 0 in array.shape:
        raise ValueError(f"a patch has rows and columns, not the shape {array.shape}")
    array = _single_precision(array) if transfer is None else _stored(array)
    if not _is_direct(array):
        array = numpy.array(array, order="C", copy=True)
    pixels = initialised(s.sonject_pixels)
    pixels.kind = _KINDS[array.dtype] if transfer is None else STORED_KINDS[array.dtype]
    pixels.transfer = keys_text("transfer", transfer)
    pixels.rows, pixels.columns = array.shape
    pixels.row_stride = array.strides[0] if array.shape[0] > 1 else 0
    pixels.data = array.ctypes.data
    return pixels, array
