"""Finds and loads libsonject, once."""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
import pathlib
import sys
from typing import Iterator

from ._interface import FUNCTIONS, VERSION


def _file_names() -> list[str]:
    if sys.platform == "win32":
        return ["libsonject.dll", "libsonject-0.dll"]
    if sys.platform == "darwin":
        return ["libsonject.0.dylib", "libsonject.dylib"]
    return ["libsonject.so.0", "libsonject.so"]


def _candidates() -> Iterator[str]:
    """Yields names to load, in order: SONJECT_LIBRARY alone if set, beside the package, system."""
    chosen = os.environ.get("SONJECT_LIBRARY")
    if chosen:
        # The library looks for its decoder beside itself, also after a change of folder.
        yield os.path.abspath(chosen) if os.path.dirname(chosen) else chosen
        return
    package = pathlib.Path(__file__).resolve().parent
    for folder in (package, package.parent, package.parents[2] / "lib"):  # the last one in a build
        for name in _file_names():
            if (folder / name).is_file():
                yield str(folder / name)
    yield from _file_names()
    found = ctypes.util.find_library("sonject")
    if found:
        yield found


def _check_version(library: ctypes.CDLL) -> None:
    # Structures and functions may differ between minor versions.
    text = library.sonject_version().decode("ascii")
    if tuple(int(part) for part in text.split(".")[:2]) != VERSION[:2]:
        ours = ".".join(str(part) for part in VERSION)
        raise ImportError(
            f"libsonject is version {text}, but this Python package is for {ours}: "
            "install the pair that belongs together or set SONJECT_LIBRARY"
        )


@functools.lru_cache(maxsize=None)
def load() -> ctypes.CDLL:
    """Returns the library with all functions declared. Raises ImportError if there is none."""
    failures: list[str] = []
    for name in _candidates():
        try:
            library = ctypes.CDLL(name)
        except OSError as error:
            failures.append(str(error))
            continue
        try:
            for function, (result, parameters) in FUNCTIONS.items():
                getattr(library, function).restype = result
                getattr(library, function).argtypes = parameters
        except AttributeError as error:
            raise ImportError(f"{name} is not the libsonject of this package: {error}") from None
        _check_version(library)
        return library
    raise ImportError(
        "libsonject was not found: set the environment variable SONJECT_LIBRARY to its path ("
        + "; ".join(failures)
        + ")"
    )
