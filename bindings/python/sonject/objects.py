"""The things that are put on the seabed. Lengths are overall, angles in radians."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Optional, Sequence, Union

from . import _interface as s
from ._classes import Material
from ._values import PathLike, choice, filled
from .enumerations import BurialKind, End, LevelKind, PositionKind, Shape


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


@dataclass(frozen=True, kw_only=True)
class Cut:
    """A plane that cuts off what lies more than distance_m from the centre towards a direction of
    the object's own: azimuth_rad from the nose towards its y, elevation_rad towards its z (its top
    when level). A solid shows a flat face there, also a closed mesh or user's shape."""

    azimuth_rad: float = 0.0
    elevation_rad: float = 0.0
    distance_m: float


def _cut_structure(cut: Cut) -> s.sonject_cut:
    if not isinstance(cut, Cut):
        raise TypeError(f"cuts must be Cuts, not {cut!r}")
    return filled(s.sonject_cut, **{entry.name: getattr(cut, entry.name) for entry in fields(cut)})


@dataclass(kw_only=True)
class Object:
    """Pose, surface and name, which every shape has.

    position: of the ground point under the centre; heading_rad: of the nose, from along-track
    towards range; pitch_rad: raises the nose; roll_rad: about the nose direction; burial_m: depth
    of the lowest point below the seabed, negative above it, or one of burial_fraction (of the
    height in that pose, 0 to 1) and proud_height_m (of the highest point above the seabed); cuts:
    at most two; target_strength_db or over_seabed_db: scales the echo so that its peak, between
    pixels too and speckle averaged out, has that level re 1 m^2 or over the seabed (None: as shape and material
    say); name, class_name: for truth and labels, "" for "object N" and the shape's name.
    """

    _shape: ClassVar[Shape]

    position: Position = field(default_factory=PatchCentre)
    heading_rad: float = 0.0
    pitch_rad: float = 0.0
    roll_rad: float = 0.0
    burial_m: float = 0.0
    burial_fraction: Optional[float] = None
    proud_height_m: Optional[float] = None
    cuts: Sequence[Cut] = ()
    material: Material = field(default_factory=Material)
    target_strength_db: Optional[float] = None
    over_seabed_db: Optional[float] = None
    name: str = ""
    class_name: str = ""

    def _burial_values(self) -> dict[str, Any]:
        if self.burial_fraction is None and self.proud_height_m is None:
            return {"burial_kind": BurialKind.DEPTH, "burial_m": self.burial_m}
        if self.burial_fraction is not None and self.proud_height_m is not None:
            raise ValueError("burial_fraction and proud_height_m exclude each other")
        if self.burial_m != 0.0:
            raise ValueError("burial_m excludes burial_fraction and proud_height_m")
        if self.burial_fraction is not None:
            return {"burial_kind": BurialKind.FRACTION, "burial_fraction": self.burial_fraction}
        return {"burial_kind": BurialKind.PROUD, "proud_height_m": self.proud_height_m}

    def _level_values(self) -> dict[str, Any]:
        if self.target_strength_db is not None and self.over_seabed_db is not None:
            raise ValueError("target_strength_db and over_seabed_db exclude each other")
        if self.target_strength_db is not None:
            return {"level_kind": LevelKind.TARGET_STRENGTH, "level_db": self.target_strength_db}
        if self.over_seabed_db is not None:
            return {"level_kind": LevelKind.OVER_SEABED, "level_db": self.over_seabed_db}
        return {}

    def to_structure(self) -> s.sonject_object_params:
        """The C structure. Raises TypeError or ValueError where a value does not fit into it."""
        if not isinstance(self.material, Material):
            raise TypeError(f"material must be a Material, not {self.material!r}")
        values = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        values.update(_position_values(values.pop("position")))
        for name in ("burial_m", "burial_fraction", "proud_height_m"):
            del values[name]
        values.update(self._burial_values())
        del values["target_strength_db"], values["over_seabed_db"]
        values.update(self._level_values())
        cuts = [_cut_structure(cut) for cut in values.pop("cuts")]
        if len(cuts) > s.CUTS_CAPACITY:
            raise ValueError(f"cuts must be at most {s.CUTS_CAPACITY}, not {len(cuts)}")
        values["cut_count"] = len(cuts)
        for name in ("nose_end", "tail_end"):
            if name in values:
                values[name] = choice(name, End, values[name])
        values["material"] = self.material.to_structure()
        values["shape"] = self._shape
        for name in ("parts", "path", "allows_user_shapes"):
            values.pop(name, None)
        structure = filled(s.sonject_object_params, **values)
        structure.cuts[: len(cuts)] = cuts
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
    """A cylinder, its axis along the nose direction.

    nose_end, tail_end: with an open one it is a tube whose thin wall reflects on both sides;
    nose_end_depth_m, tail_end_depth_m: of spherical ends, which the length includes; 0: half
    spheres.
    """

    _shape: ClassVar[Shape] = Shape.CYLINDER
    length_m: float
    diameter_m: float
    nose_end: End = End.FLAT
    tail_end: End = End.FLAT
    nose_end_depth_m: float = 0.0
    tail_end_depth_m: float = 0.0


@dataclass(kw_only=True)
class Capsule(Object):
    """A cylinder with spherical ends, which its length includes; axis along the nose direction."""

    _shape: ClassVar[Shape] = Shape.CAPSULE
    length_m: float
    diameter_m: float


@dataclass(kw_only=True)
class Disc(Object):
    """A disc that faces up when its pose is level; both sides reflect."""

    _shape: ClassVar[Shape] = Shape.DISC
    diameter_m: float


@dataclass(kw_only=True)
class Ellipsoid(Object):
    """An ellipsoid: length along the nose, width across it, height upwards when level."""

    _shape: ClassVar[Shape] = Shape.ELLIPSOID
    length_m: float
    width_m: float
    height_m: float


@dataclass(kw_only=True)
class Cuboid(Object):
    """The shape "box": length along the nose, width across it, height upwards when level."""

    _shape: ClassVar[Shape] = Shape.BOX
    length_m: float
    width_m: float
    height_m: float


@dataclass(kw_only=True)
class Wedge(Object):
    """A box whose top slants from height_m at the tail to front_height_m at the nose."""

    _shape: ClassVar[Shape] = Shape.WEDGE
    length_m: float
    width_m: float
    height_m: float
    front_height_m: float = 0.0


@dataclass(kw_only=True)
class Cone(Object):
    """A cone, its tip up when level."""

    _shape: ClassVar[Shape] = Shape.CONE
    diameter_m: float
    height_m: float


@dataclass(kw_only=True)
class TruncatedCone(Object):
    """A cone without its tip: diameter_m below, top_diameter_m above when level."""

    _shape: ClassVar[Shape] = Shape.TRUNCATED_CONE
    diameter_m: float
    top_diameter_m: float
    height_m: float


@dataclass(kw_only=True)
class Torus(Object):
    """A ring, lying flat when level: diameter_m is its outline's, height_m its thickness."""

    _shape: ClassVar[Shape] = Shape.TORUS
    diameter_m: float
    height_m: float


@dataclass(frozen=True)
class Part:
    """A shape and where it lies in an object of Parts.

    shape: any one but Parts; its sizes, ends, cuts and material count, its name, class, position,
    pose and burial do not; along_m, across_m, up_m: of its centre from the object's origin, along
    the object's nose, its own y and its own z; heading_rad: of its nose from the object's towards
    that y; pitch_rad: raises its nose towards that z; roll_rad: about its nose.
    """

    shape: Object
    along_m: float = field(default=0.0, kw_only=True)
    across_m: float = field(default=0.0, kw_only=True)
    up_m: float = field(default=0.0, kw_only=True)
    heading_rad: float = field(default=0.0, kw_only=True)
    pitch_rad: float = field(default=0.0, kw_only=True)
    roll_rad: float = field(default=0.0, kw_only=True)

    def to_structures(self) -> tuple[s.sonject_object_params, s.sonject_part_params]:
        """The C structures of shape and place. Raises TypeError or ValueError as the shape's does."""
        if not isinstance(self.shape, Object) or isinstance(self.shape, Parts):
            raise TypeError(f"shape of a Part must be an Object of one shape, not {self.shape!r}")
        names = [entry.name for entry in fields(self) if entry.name != "shape"]
        place = {name: getattr(self, name) for name in names}
        return self.shape.to_structure(), filled(s.sonject_part_params, **place)


@dataclass(kw_only=True)
class Mesh(Object):
    """Triangles of a file that ``Scene.add_mesh`` has read; mesh: its number there.

    The object's centre is the middle of the mesh's bounding box.
    """

    _shape: ClassVar[Shape] = Shape.MESH
    mesh: int


@dataclass(kw_only=True)
class UserShape(Object):
    """Code that ``Scene.add_user_shape`` has taken; user_shape: its number there."""

    _shape: ClassVar[Shape] = Shape.USER
    user_shape: int


@dataclass
class Parts(Object):
    """The union of its parts, which may overlap: ``Parts([Part(Sphere(diameter_m=1)), ...])``.

    Each part has the material of its own shape, not the whole's, and cuts of its own; the whole can
    have none.
    """

    _shape: ClassVar[Shape] = Shape.PARTS
    parts: Sequence[Part]

    def to_structure(self) -> s.sonject_object_params:
        """As of every object; the parts are structures of their own."""
        if len(self.parts) == 0:
            raise ValueError("parts must be at least one")
        for part in self.parts:
            if not isinstance(part, Part):
                raise TypeError(f"each of parts must be a Part, not {part!r}")
        return super().to_structure()


@dataclass
class Target(Object):
    """What a target's file describes, such as those of tools/targets: ``Target("tyre.yaml")``.

    path: of the file, which tells shape or parts and material; class and name too, unless given
    here; allows_user_shapes: its shape may be code, which then can do what the process can: only
    for files that you trust.
    """

    _shape: ClassVar[Shape] = Shape.SPHERE  # of no meaning: the file's counts

    path: PathLike
    allows_user_shapes: bool = field(default=False, kw_only=True)

    def to_structure(self) -> s.sonject_object_params:
        """Its pose and level. Raises TypeError or ValueError where a value does not fit into it."""
        if len(self.cuts) > 0 or self.material != Material():
            raise ValueError("material and cuts of a Target are its file's")
        return super().to_structure()
