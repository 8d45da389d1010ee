"""What the classes of C structures have in common, and what some of them have beside their fields."""

import ctypes
import enum
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Optional, Sequence, Type, TypeVar

import numpy
import numpy.typing

from . import _interface as s
from ._library import load
from ._values import choice, fill, filled, initialised, real_number, short_text, text
from .enumerations import Status

Self = TypeVar("Self", bound="Mirror")
Array = numpy.typing.NDArray[Any]


def library_default() -> Any:
    """A field whose default the library gives."""
    return field(default=None)


def _from_c(kind: Any, value: Any) -> Any:
    """A member of a structure as a field of this type."""
    if isinstance(value, bytes):
        return text(value)
    if isinstance(value, ctypes.Structure):
        return kind.from_structure(value)
    return kind(value) if isinstance(kind, type) and issubclass(kind, (bool, enum.IntEnum)) else value


class Mirror:
    """Mirrors one C structure; fields have the names of the structure's."""

    _structure: ClassVar[Type[ctypes.Structure]]

    @classmethod
    def from_structure(cls: Type[Self], structure: Any) -> Self:
        entries = fields(cls)  # type: ignore[arg-type]  # what derives from this is a dataclass
        return cls(**{each.name: _from_c(each.type, getattr(structure, each.name)) for each in entries})


class Answer(Mirror):
    """What the library tells."""


@dataclass(kw_only=True)
class Parameters(Mirror):
    """What the library is given. Fields that are not given take its defaults."""

    def __post_init__(self) -> None:
        defaults = initialised(self._structure)
        for entry in fields(self):
            value = getattr(self, entry.name)
            if value is None:
                value = _from_c(entry.type, getattr(defaults, entry.name))
            elif isinstance(entry.type, type) and issubclass(entry.type, enum.IntEnum):
                value = choice(entry.name, entry.type, value)
            setattr(self, entry.name, bool(value) if entry.type is bool else value)

    def _values(self) -> dict[str, Any]:
        """The fields as the structure takes them."""
        values = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        for entry in fields(self):
            if not isinstance(entry.type, type):
                continue
            if issubclass(entry.type, enum.IntEnum):
                values[entry.name] = choice(entry.name, entry.type, values[entry.name])
            elif issubclass(entry.type, Parameters):
                if not isinstance(values[entry.name], entry.type):
                    wanted = entry.type.__name__
                    raise TypeError(f"{entry.name} must be a {wanted}, not {values[entry.name]!r}")
                values[entry.name] = values[entry.name].to_structure()
        return values

    def to_structure(self) -> Any:
        """The C structure. Raises TypeError or ValueError where a value does not fit into it."""
        return filled(self._structure, **self._values())


class BoxBase(Answer):
    @property
    def slices(self: Any) -> tuple[slice, slice]:
        """To cut the box out of a layer: ``result.image[box.slices]``."""
        return (
            slice(self.first_row, self.first_row + self.rows),
            slice(self.first_column, self.first_column + self.columns),
        )


AnyMaterial = TypeVar("AnyMaterial", bound="MaterialBase")


@dataclass(kw_only=True)
class MaterialBase(Parameters):
    @staticmethod
    def names() -> list[str]:
        """The materials that named() knows."""
        names: list[str] = []
        while (name := load().sonject_material_name(len(names))) is not None:
            names.append(name.decode("ascii"))
        return names

    @classmethod
    def named(cls: Type[AnyMaterial], name: str, **changes: Any) -> AnyMaterial:
        """A material that the library knows: ``Material.named("steel", roughness_m=2e-3)``."""
        structure = initialised(cls._structure)
        status = load().sonject_material_named(
            short_text("name", name, s.NAME_CAPACITY), ctypes.byref(structure)
        )
        if status != Status.OK:
            raise ValueError(f"{name!r} is not one of {', '.join(cls.names())}")
        return replace(cls.from_structure(structure), **changes)


@dataclass(kw_only=True)
class MotionBase(Parameters):
    sways: Sequence[tuple[float, float, float]] = ()
    yaws: Sequence[tuple[float, float, float]] = ()

    def to_structure(self) -> Any:
        values = self._values()
        sines = {name: list(values.pop(name + "s")) for name in ("sway", "yaw")}
        counts = {name + "_count": len(given) for name, given in sines.items()}
        structure = filled(self._structure, **values, **counts)
        for name, given in sines.items():
            _fill_sines(name, given, getattr(structure, name + "s"))
        return structure


def _fill_sines(name: str, sines: Sequence[Sequence[float]], room: Any) -> None:
    if len(sines) > len(room):
        raise ValueError(f"{name}s must be at most {len(room)}, not {len(sines)}")
    members = [member for member, _ in room._type_._fields_]
    for place, sine in zip(room, sines):
        if len(sine) != len(members):
            raise ValueError(f"a {name} has {members[0]}, {members[1]} and {members[2]}")
        fill(place, dict(zip(members, sine)))


@dataclass(kw_only=True)
class InjectionBase(Parameters):
    noise_floor_db: Optional[float] = None

    def __post_init__(self) -> None:
        given = self.noise_floor_db
        super().__post_init__()
        self.noise_floor_db = given

    def _values(self) -> dict[str, Any]:
        values = super()._values()
        values["estimate_noise"] = int(self.noise_floor_db is None)
        if self.noise_floor_db is None:
            del values["noise_floor_db"]
        return values


class ElementLayoutBase(Answer):
    @property
    def shape(self: Any) -> tuple[int, int, int]:
        """Pings, hydrophones, samples."""
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
        """Of the samples, after transmission."""
        steps = numpy.arange(self.samples) / self.elements.sampling_rate_hz
        return numpy.asarray(self.elements.first_time_s + steps)
