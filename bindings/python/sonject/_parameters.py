"""What classes that mirror C structures have in common."""

from __future__ import annotations

import ctypes
import enum
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Mapping, Type

from ._values import choice, fill, initialised


def library_default() -> Any:
    """A field whose default the library gives."""
    return field(default=None)


@dataclass(kw_only=True)
class Parameters:
    """Mirrors one C structure; fields have the names of the structure's."""

    _structure: ClassVar[Type[ctypes.Structure]]
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {}

    def __post_init__(self) -> None:
        defaults = initialised(self._structure)
        for entry in fields(self):
            if getattr(self, entry.name) is None:
                setattr(self, entry.name, getattr(defaults, entry.name))
            if entry.name in self._choices:
                kind = self._choices[entry.name]
                setattr(self, entry.name, choice(entry.name, kind, getattr(self, entry.name)))

    def _values(self) -> dict[str, Any]:
        values = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        for name, kind in self._choices.items():
            values[name] = choice(name, kind, values[name])
        return values

    def to_structure(self) -> Any:
        """The C structure. Raises TypeError or ValueError where a value does not fit into it."""
        structure = initialised(self._structure)
        fill(structure, self._values())
        return structure
