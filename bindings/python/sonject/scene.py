"""Scenes, with the keys of scene files."""

from __future__ import annotations

import contextlib
import ctypes
import html
import json
import os
import threading
from typing import TYPE_CHECKING, Any, Iterator, Optional

import numpy

from . import _interface as s
from ._values import (
    Overrides, PathLike, absolute_file_name, file_name, filled, key_text, override_texts, plain_text,
    real_numbers,
)
from .context import Context, Handle, counted, default_context
from .errors import SonjectError

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .keys import SceneKeys


class Scene(Handle):
    """A scene, in the keys of scene files, which tools/scenes/KEYS.md lists.

    >>> scene = Scene(
    ...     sonar={"frequency": "100 kHz", "bandwidth": "30 kHz", "altitude": 10},
    ...     input={"geometry": {"row_spacing": "2.5 cm", "column_spacing": 0.025, "first_slant_range": 40}},
    ...     objects=[{"shape": "sphere", "diameter": 0.5, "material": "steel"}],
    ... )
    >>> scene["objects[0].burial"] = "5 cm"

    A number is in m, Hz, m/s, degrees, s; a text may have another unit. Sections are dictionaries,
    lists may be arrays. If a call is given the image as an array, ``input`` has only its geometry.
    File names are relative to the working directory. context: None for the thread's own one.
    """

    _noun = "scene"

    def __init__(
        self,
        *,
        context: Optional[Context] = None,
        **keys: Unpack[SceneKeys],
    ) -> None:
        context = default_context() if context is None else context
        text = plain_text("scene", key_text("scene", {"sonject": 1, **keys}))
        super().__init__(context, _read(context, None, text=text))

    @classmethod
    def read(
        cls,
        path: PathLike,
        overrides: Overrides = (),
        context: Optional[Context] = None,
    ) -> "Scene":
        """Reads a scene file. If it has bands, the override "band" chooses one of ``Scene.bands``.

        overrides: "key.path=value" texts, or a mapping of key paths to values, which replace or add
        keys: ``{"input.path": "swath.tif", "objects[0].heading": "30 deg"}``.
        """
        context = default_context() if context is None else context
        texts = override_texts(overrides)
        pointer = _read(context, absolute_file_name("path", path),
                        overrides=texts, override_count=len(texts))
        return cls._adopt(context, pointer)

    @classmethod
    def _adopt(cls, context: Context, pointer: Any) -> "Scene":
        """Returns the scene of a handle that the library made."""
        scene = cls.__new__(cls)
        Handle.__init__(scene, context, pointer)
        return scene

    @staticmethod
    def bands(
        path: PathLike, overrides: Overrides = (), context: Optional[Context] = None
    ) -> list[str]:
        """Returns the bands from which an override must choose; arguments as in ``read``."""
        texts = override_texts(overrides)
        context = default_context() if context is None else context
        params = filled(s.sonject_scene_read_params, override_count=len(texts),
                        overrides=ctypes.cast(texts, ctypes.POINTER(ctypes.c_char_p)))
        return context.text("sonject_scene_bands", context, file_name("path", path),
                            ctypes.byref(params)).split()

    def __setitem__(self, key: str, value: Any) -> None:
        """Sets a key, a whole section or an entry: ``scene["objects[1]"] = {...}``.

        The index behind a list's last one adds an entry. The next use of the scene checks values.
        """
        self._context.call("sonject_scene_set", self, plain_text("key", key),
                           plain_text(key, key_text(key, value)))

    def __getitem__(self, key: str) -> Any:
        """Returns the value of a key: a number, text, dictionary or list; "" is the whole scene.

        Quantities are numbers in SI units and degrees. File names are absolute. A table in memory
        has "columns" and "values". Raises KeyError if the scene does not set the key: defaults and
        values added by a calibration are left out.
        """
        value = self._get(key)
        if value is None:
            raise KeyError(key)
        return value

    def __contains__(self, key: object) -> bool:
        """Returns whether the scene sets a key."""
        return self._get(key) is not None

    def _get(self, key: Any) -> Any:
        return json.loads(self._context.text("sonject_scene_get", self, plain_text("key", key)))

    def set_table(self, key: str, values: Any = None, /, **columns: Any) -> None:
        """Sets a key that names a file of numbers to numbers in memory.

        Columns have the names that the file's would have:
        ``scene.set_table("sonar.motion.file", along_track_m=x, sway_m=sway)``. The heights of
        ``seabed.relief[0].heights.file`` are an array of rows and columns instead.
        """
        if (values is None) == (not columns):
            raise TypeError("give either an array of heights or columns by their names")
        arrays = {name: real_numbers(name, column) for name, column in columns.items()}
        if len({array.size for array in arrays.values()}) > 1:
            sizes = ", ".join(f"{name} {array.size}" for name, array in arrays.items())
            raise ValueError(f"columns must be of one length, not {sizes}")
        table = numpy.asarray(numpy.column_stack(list(arrays.values())) if columns else values)
        if table.ndim != 2 or table.dtype.kind not in "fiu":
            raise ValueError(f"{key} takes rows and columns of real numbers, not the shape "
                             f"{table.shape} of {table.dtype}")
        table = numpy.ascontiguousarray(table, numpy.float64)
        names = plain_text("columns", ", ".join(columns)) if columns else None
        self._context.call("sonject_scene_set_table", self, plain_text("key", key), names,
                           table.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), *table.shape)

    def text(self) -> str:
        """Returns the scene as the text of a scene file, without tables in memory.

        File names in the text are absolute.
        """
        return self._context.text("sonject_scene_text", self)

    def write(self, path: PathLike) -> None:
        """Writes a scene file, whole or not at all. Raises ValueError if a table is in memory."""
        content = self._whole_text()
        name = os.fsdecode(file_name("path", path))
        part = f"{name}.{os.getpid()}-{threading.get_ident()}.part"
        try:
            with open(part, "w", encoding="utf-8", newline="\n") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, name)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(part)
            raise

    def _whole_text(self) -> str:
        for key in _tables("", self[""]):
            raise ValueError(f"{key} is a table in memory, which the text of a scene cannot hold: "
                             "write it to a file and set the file's name")
        return self.text()

    def __eq__(self, other: object) -> bool:
        """Returns whether both mean the same: 10, "10 m" and "1000 cm" are equal."""
        if not isinstance(other, Scene):
            return NotImplemented
        return self is other or bool(self[""] == other[""])

    __hash__ = None  # type: ignore[assignment]  # scenes are mutable

    def __copy__(self) -> "Scene":
        return _of_text(self._whole_text(), self._context)

    def __deepcopy__(self, _memo: Any) -> "Scene":
        return self.__copy__()

    def __reduce__(self) -> Any:
        return _of_text, (self._whole_text(),)

    def _summary(self) -> str:
        return f"of {counted(self.object_count, 'object')}"

    def _repr_html_(self) -> Optional[str]:
        """Returns the scene's text for notebooks; None if it has none or is closed."""
        try:
            return f"<pre>{html.escape(self.text())}</pre>"
        except (SonjectError, ValueError):
            return None

    @property
    def object_count(self) -> int:
        """The number of objects."""
        count = ctypes.c_uint32()
        self._context.call("sonject_scene_object_count", self, ctypes.byref(count))
        return count.value


def _read(context: Context, path: Optional[bytes], **given: Any) -> Any:
    if "overrides" in given:
        given["overrides"] = ctypes.cast(given["overrides"], ctypes.POINTER(ctypes.c_char_p))
    params = filled(s.sonject_scene_read_params, **given)
    return context.make(s.sonject_scene, "sonject_scene_read", context, path, ctypes.byref(params))


def _of_text(content: str, context: Optional[Context] = None) -> Scene:
    context = default_context() if context is None else context
    pointer = _read(context, None, text=plain_text("scene", content))
    return Scene._adopt(context, pointer)


def _tables(key: str, value: Any) -> Iterator[str]:
    """Yields the keys of tables in memory below the value of a key."""
    if isinstance(value, dict) and set(value) == {"columns", "values"}:
        yield key
    elif isinstance(value, dict):
        for name, each in value.items():
            yield from _tables(f"{key}.{name}".lstrip("."), each)
    elif isinstance(value, list):
        for index, each in enumerate(value):
            yield from _tables(f"{key}[{index}]", each)
