"""Surfaces: how much sound they return, and where to."""

from __future__ import annotations

import ctypes
import enum
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Mapping, Type

from . import _structures as s
from ._library import load
from ._parameters import Parameters, library_default
from ._values import initialised, short_text
from .enumerations import ReflectionKind, Status


@dataclass(kw_only=True)
class Material(Parameters):
    """How much sound a surface returns, and where to.

    reflection_kind: constant takes reflection, the amplitude of the mirror-like part, -1...1, at
    every angle; fluid takes the reflection of a fluid half-space of density_ratio, speed_ratio (to
    the water's) and loss (imaginary over real part of the wavenumber). roughness_m: rms height.
    lambert: coefficient mu of the rough part, linear; lambert_exponent: 1 for Lambert's law;
    glossy_albedo, glossy_slope: cone about the mirror direction, the most energy that it returns and
    the rms slope of its facets.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_material_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {"reflection_kind": ReflectionKind}

    reflection_kind: ReflectionKind = library_default()
    reflection: float = library_default()
    roughness_m: float = library_default()
    lambert: float = library_default()
    lambert_exponent: float = library_default()
    glossy_albedo: float = library_default()
    glossy_slope: float = library_default()
    density_ratio: float = library_default()
    speed_ratio: float = library_default()
    loss: float = library_default()

    @classmethod
    def from_structure(cls, structure: s.sonject_material_params) -> "Material":
        return cls(**{entry.name: getattr(structure, entry.name) for entry in fields(cls)})

    @staticmethod
    def names() -> list[str]:
        """The materials that named() knows."""
        names: list[str] = []
        while (name := load().sonject_material_name(len(names))) is not None:
            names.append(name.decode("ascii"))
        return names

    @classmethod
    def named(cls, name: str, **changes: Any) -> "Material":
        """A material that the library knows: ``Material.named("steel", roughness_m=2e-3)``."""
        structure = initialised(s.sonject_material_params)
        status = load().sonject_material_named(
            short_text("name", name, s.NAME_CAPACITY), ctypes.byref(structure)
        )
        if status != Status.OK:
            raise ValueError(f"{name!r} is not one of {', '.join(cls.names())}")
        return replace(cls.from_structure(structure), **changes)
