"""The things that are put on the seabed. Lengths are overall, angles in radians."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Union

from . import _structures as s
from ._values import fill, initialised
from .enumerations import PositionKind, Shape
from .material import Material


@dataclass(frozen=True)
class PatchCentre:
    """In the middle of the patch."""


@dataclass(frozen=True)
class Metres:
    """Ground point under the centre: along-track and apparent slant range, as the geometry counts
    them."""

    along_track_m: float
    slant_range_m: float


@dataclass(frozen=True)
class Pixels:
    """Ground point under the centre: row and column of the swath, pixel centres at integers."""

    row: float
    column: float


Position = Union[PatchCentre, Metres, Pixels]


def _position_values(position: Position) -> dict[str, Any]:
    if isinstance(position, PatchCentre):
        kind, along, slant = PositionKind.PATCH_CENTRE, 0.0, 0.0
    elif isinstance(position, Metres):
        kind, along, slant = PositionKind.METRES, position.along_track_m, position.slant_range_m
    elif isinstance(position, Pixels):
        kind, along, slant = PositionKind.PIXELS, position.row, position.column
    else:
        raise TypeError(f"position must be PatchCentre, Metres or Pixels, not {position!r}")
    return {"position_kind": kind, "position_along": along, "position_range": slant}


@dataclass(kw_only=True)
class Object:
    """Pose, surface and name, which every shape has.

    position: of the ground point under the centre; heading_rad: of the nose, from along-track
    towards range; pitch_rad: raises the nose; roll_rad: about the nose direction; burial_m: depth
    of the lowest point below the seabed, negative above it; name, class_name: for truth and
    labels, "" for "object N" and the shape's name.
    """

    _shape: ClassVar[Shape]

    position: Position = field(default_factory=PatchCentre)
    heading_rad: float = 0.0
    pitch_rad: float = 0.0
    roll_rad: float = 0.0
    burial_m: float = 0.0
    material: Material = field(default_factory=Material)
    name: str = ""
    class_name: str = ""

    def to_structure(self) -> s.sonject_object_params:
        """The C structure. Raises TypeError or ValueError where a value does not fit into it."""
        if not isinstance(self.material, Material):
            raise TypeError(f"material must be a Material, not {self.material!r}")
        values = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        values.update(_position_values(values.pop("position")))
        values["material"] = self.material.to_structure()
        values["shape"] = self._shape
        structure = initialised(s.sonject_object_params)
        fill(structure, values)
        return structure


@dataclass(kw_only=True)
class Plane(Object):
    """A rectangle that faces up when its pose is level; both sides reflect."""

    _shape: ClassVar[Shape] = Shape.PLANE
    length_m: float
    width_m: float


@dataclass(kw_only=True)
class Sphere(Object):
    """A sphere."""

    _shape: ClassVar[Shape] = Shape.SPHERE
    diameter_m: float


@dataclass(kw_only=True)
class Cylinder(Object):
    """A cylinder with flat ends, its axis along the nose direction."""

    _shape: ClassVar[Shape] = Shape.CYLINDER
    length_m: float
    diameter_m: float


@dataclass(kw_only=True)
class Capsule(Object):
    """A cylinder with spherical ends, which its length includes; axis along the nose direction."""

    _shape: ClassVar[Shape] = Shape.CAPSULE
    length_m: float
    diameter_m: float
