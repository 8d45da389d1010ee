"""Python values into C fields, refusing what ctypes would quietly cut or wrap."""

from __future__ import annotations

import ctypes
import enum
import numbers
import operator
import os
from typing import Any, Iterable, Mapping, Optional, Tuple, Type, TypeVar, Union

import numpy

from ._library import load

PathLike = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Overrides = Union[Iterable[str], Mapping[str, Any]]
AnyStructure = TypeVar("AnyStructure", bound=ctypes.Structure)
AnyEnum = TypeVar("AnyEnum", bound=enum.IntEnum)

_LARGEST: dict[Any, int] = {ctypes.c_uint32: 2**32 - 1, ctypes.c_uint64: 2**64 - 1}


def whole_number(name: str, value: Any, largest: int) -> int:
    """value as an int within 0...largest."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not 0 <= number <= largest:
        raise ValueError(f"{name} must lie within 0...{largest}, not {number}")
    return number


def real_number(name: str, value: Any) -> float:
    """value as a float; whether it makes sense is the library's to say."""
    if not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a number, not {value!r}")
    return float(value)


def real_numbers(name: str, values: Any) -> Any:
    """values, an array or a sequence of numbers in one row, as an array of doubles."""
    if isinstance(values, numpy.ma.MaskedArray):
        raise TypeError(f"{name} must not be masked: its mask would be lost")
    array = numpy.asarray(values)
    if array.size > 0 and array.dtype.kind not in "iuf":
        raise TypeError(f"{name} must be numbers, not {array.dtype}")
    if array.ndim != 1:
        raise ValueError(f"{name} must be in one row, not of shape {array.shape}")
    return numpy.ascontiguousarray(array, dtype=numpy.float64)


def choice(name: str, kind: Type[AnyEnum], value: Any) -> AnyEnum:
    """value as a member of kind; a member's name in any case is one too."""
    if isinstance(value, str) and value.upper() in kind.__members__:
        return kind[value.upper()]
    if not isinstance(value, str):
        try:
            return kind(value)
        except ValueError:
            pass
    names = ", ".join(member.lower() for member in kind.__members__)
    raise ValueError(f"{name} must be one of {names}, not {value!r}")


def plain_text(name: str, value: Any) -> bytes:
    """value in UTF-8; a NUL would end it early."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text, not {value!r}")
    if "\0" in value:
        raise ValueError(f"{name} contains a NUL: {value!r}")
    return value.encode("utf-8")


def short_text(name: str, value: Any, capacity: int) -> bytes:
    """value in UTF-8 with room for the terminator."""
    encoded = plain_text(name, value)
    if len(encoded) >= capacity:
        raise ValueError(f"{name} must have at most {capacity - 1} bytes: {value!r}")
    return encoded


def file_name(name: str, value: Any) -> bytes:
    """A path in the file system's encoding."""
    try:
        encoded = os.fsencode(value)
    except TypeError:
        raise TypeError(f"{name} must be a path, not {value!r}") from None
    if b"\0" in encoded:
        raise ValueError(f"{name} contains a NUL: {value!r}")
    return encoded


def optional_file_name(name: str, value: Any) -> Optional[bytes]:
    return None if value is None else file_name(name, value)


def set_shard(params: Any, shard: Tuple[int, int]) -> None:
    """shard (i, K) into the structure; whether i is one of K is the library's to say."""
    index, count = shard
    params.shard_index = whole_number("shard", index, 2**32 - 1)
    params.shard_count = whole_number("shard", count, 2**32 - 1)


def initialised(kind: Type[AnyStructure]) -> AnyStructure:
    """A structure with the library's defaults."""
    structure = kind()
    getattr(load(), kind.__name__ + "_init")(ctypes.byref(structure))
    return structure


def sized(kind: Type[AnyStructure]) -> AnyStructure:
    """A zeroed structure that carries its size."""
    return kind(struct_size=ctypes.sizeof(kind))


def fill(structure: ctypes.Structure, values: Mapping[str, Any]) -> None:
    """Assigns each named value, checked for the field's type."""
    types = {field[0]: field[1] for field in structure._fields_}
    for name, value in values.items():
        kind = types[name]
        if kind is ctypes.c_double:
            setattr(structure, name, real_number(name, value))
        elif kind in _LARGEST:
            setattr(structure, name, whole_number(name, value, _LARGEST[kind]))
        elif issubclass(kind, ctypes.Array):
            setattr(structure, name, short_text(name, value, ctypes.sizeof(kind)))
        else:
            setattr(structure, name, value)


def override_texts(overrides: Overrides) -> list[bytes]:
    """ "key.path=value" texts, of these or of a mapping of key paths to values."""
    if isinstance(overrides, str):
        raise TypeError("overrides must be a list of texts or a mapping, not one text")
    if isinstance(overrides, Mapping):
        overrides = [f"{key}={value}" for key, value in overrides.items()]
    return [file_name("override", text) for text in overrides]
