"""What describes a scene, apart from its objects. SI units, angles in radians.

Whatever is not given takes the library's default, which the attribute shows afterwards. Ranges of
values are checked by the library when a scene is made of them.
"""

from __future__ import annotations

import ctypes
import enum
import math
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Mapping, Optional, Sequence, Type, Union

from . import _structures as s
from ._library import load
from ._parameters import Parameters, library_default
from ._values import PathLike, fill, initialised, real_number, sized, whole_number
from .enumerations import (
    ColumnRule,
    Estimator,
    ForwardRule,
    Match,
    Mode,
    PulseKind,
    PulseWindow,
    ResponseWindow,
    SeabedMap,
    Side,
    SonarKind,
    TransferKind,
)
from .material import Material


def from_degrees(angle: float) -> float:
    """An angle in radians from one in degrees: ``heading_rad=from_degrees(30)``."""
    return math.radians(angle)


def absorption(
    frequency_hz: float,
    temperature_celsius: float,
    salinity_permille: float = 35.0,
    depth_m: float = 0.0,
    ph: float = 8.0,
) -> float:
    """Absorption of sea water in dB/m after Francois and Garrison (1982).

    200 Hz...1 MHz, -2...30 degrees Celsius, 0...40 per mille, 0...5000 m below the sea surface,
    pH 7...9; NaN outside of these.
    """
    return float(
        load().sonject_absorption(
            real_number("frequency_hz", frequency_hz),
            real_number("temperature_celsius", temperature_celsius),
            real_number("salinity_permille", salinity_permille),
            real_number("depth_m", depth_m),
            real_number("ph", ph),
        )
    )


@dataclass(kw_only=True)
class Sonar(Parameters):
    """The sonar as its images show it.

    response_window: weighting of the aspects that form a pixel; centre_frequency_hz, bandwidth_hz:
    the range width at -3 dB is c / (2 bandwidth); altitude_m: height of the track over the mean
    seabed; along_track_resolution_m: 0 takes the image's row spacing; transducer_side_m: side of
    the source, 0 for a point; taylor_sidelobe_db, taylor_terms: for the Taylor window only; kind:
    synthetic or real aperture; aperture_rad: synthetic: full angle of the aspects that shadows and
    rough highlights are integrated over, 0 for broadside alone, negative for the response's own;
    array_*: real: size and pose of the array.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_sonar_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {
        "response_window": ResponseWindow,
        "kind": SonarKind,
    }

    response_window: ResponseWindow = library_default()
    centre_frequency_hz: float = library_default()
    bandwidth_hz: float = library_default()
    altitude_m: float = library_default()
    along_track_resolution_m: float = library_default()
    transducer_side_m: float = library_default()
    taylor_sidelobe_db: float = library_default()
    taylor_terms: int = library_default()
    kind: SonarKind = library_default()
    aperture_rad: float = library_default()
    array_length_m: float = library_default()
    array_height_m: float = library_default()
    array_heading_rad: float = library_default()
    array_pitch_rad: float = library_default()
    array_depression_rad: float = library_default()


@dataclass(kw_only=True)
class Pulse(Parameters):
    """The compressed pulse.

    kind: gaussian, or chirp, a linear sweep over the sonar's bandwidth (Scene.set_pulse_table takes
    samples); window: weighting of the chirp's spectrum; taylor_sidelobe_db, taylor_terms: for the
    Taylor window only.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_pulse_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {
        "kind": PulseKind,
        "window": PulseWindow,
    }

    kind: PulseKind = library_default()
    window: PulseWindow = library_default()
    taylor_terms: int = library_default()
    taylor_sidelobe_db: float = library_default()


@dataclass(kw_only=True)
class Motion(Parameters):
    """Residual motion of a synthetic aperture's sonar: sway and yaw, which defocus.

    sways: up to 8 sines of amplitude_m, wavelength_m (along-track) and phase_rad, added together;
    random_rms_m, random_correlation_m: of a Gaussian random sway; seed: of that one. yaw_*, yaws: of
    an array of hydrophones whose pings are yaw_advance_m apart, in the same way, amplitudes in rad;
    yaw_bias_rad: of all pings.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_motion_params

    sways: Sequence[tuple[float, float, float]] = ()
    random_rms_m: float = library_default()
    random_correlation_m: float = library_default()
    seed: int = library_default()
    yaw_advance_m: float = library_default()
    yaw_bias_rad: float = library_default()
    yaw_random_rms_rad: float = library_default()
    yaw_random_correlation_m: float = library_default()
    yaw_seed: int = library_default()
    yaws: Sequence[tuple[float, float, float]] = ()

    def to_structure(self) -> Any:
        values = self._values()
        sways = list(values.pop("sways"))
        yaws = list(values.pop("yaws"))
        structure = initialised(self._structure)
        fill(structure, {**values, "sway_count": len(sways), "yaw_count": len(yaws)})
        _fill_sines("sway", sways, structure.sways, s.sonject_sway)
        _fill_sines("yaw", yaws, structure.yaws, s.sonject_yaw)
        return structure


def _fill_sines(
    name: str, sines: Sequence[Sequence[float]], room: Any, structure: Type[ctypes.Structure]
) -> None:
    if len(sines) > len(room):
        raise ValueError(f"{name}s must be at most {len(room)}, not {len(sines)}")
    members = [field[0] for field in structure._fields_]
    for i, sine in enumerate(sines):
        if len(sine) != len(members):
            raise ValueError(f"a {name} has {members[0]}, {members[1]} and {members[2]}")
        for member, value in zip(members, sine):
            setattr(room[i], member, real_number(member, value))


@dataclass(kw_only=True)
class Medium(Parameters):
    """The water.

    sound_speed_mps: of no meaning where the scene has layers or a profile;
    reference_sound_speed_mps: that the image processor assumed; 0: the true one, around the seabed;
    absorption_db_per_m: absorption() gives that of sea water.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_medium_params

    sound_speed_mps: float = library_default()
    reference_sound_speed_mps: float = library_default()
    absorption_db_per_m: float = library_default()


@dataclass(kw_only=True)
class Seabed(Parameters):
    """The seabed, whose reflectivity comes from the image: a plane, unless Scene.set_relief or a
    scene file gives it heights.

    map: the reflectivity when the patch is resynthesised; lambert: backscatter per area and solid
    angle at normal incidence, linear, at most 1/pi; level_radius_m: of the smooth local mean that
    lambert stands for; despeckle_radius_m: of the despeckled map; forward: the surface for sound
    that does not go straight back, as between seabed and target, whose lambert is NaN for the
    seabed's own, as in ``Material.named("fine sand", lambert=math.nan)``; forward_rule: whether the
    map counts there too.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_seabed_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {
        "map": SeabedMap,
        "forward_rule": ForwardRule,
    }

    map: SeabedMap = library_default()
    lambert: float = library_default()
    level_radius_m: float = library_default()
    despeckle_radius_m: float = library_default()
    forward_rule: ForwardRule = library_default()
    forward: Material = library_default()

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.forward, s.sonject_material_params):
            self.forward = Material.from_structure(self.forward)

    def _values(self) -> dict[str, Any]:
        values = super()._values()
        if not isinstance(self.forward, Material):
            raise TypeError(f"forward must be a Material, not {self.forward!r}")
        values["forward"] = self.forward.to_structure()
        return values


@dataclass(kw_only=True)
class Surface(Parameters):
    """The sea surface, a plane over the seabed that reflects as a mirror and, where it is rough, scatters.

    water_depth_m: its height over the mean seabed, above the sonar; 0: so far away that nothing of it
    is heard. material: reflection -1 for air above water; roughness_m is the rms height of the waves;
    lambert and the cone are of what they scatter, glossy_albedo NaN for all that lambert leaves.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_surface_params

    water_depth_m: float = library_default()
    material: Material = library_default()

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.material, s.sonject_material_params):
            self.material = Material.from_structure(self.material)

    def _values(self) -> dict[str, Any]:
        values = super()._values()
        if not isinstance(self.material, Material):
            raise TypeError(f"material must be a Material, not {self.material!r}")
        values["material"] = self.material.to_structure()
        return values


@dataclass(kw_only=True)
class Geometry(Parameters):
    """Where the pixels lie: rows are track positions, columns slant ranges, both pixel centres.

    first_slant_range_m has no useful default: it is the slant range of column 0.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_geometry_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {"side": Side}

    first_slant_range_m: float
    row_spacing_m: float = library_default()
    column_spacing_m: float = library_default()
    first_along_track_m: float = library_default()
    side: Side = library_default()


@dataclass(kw_only=True)
class Transfer(Parameters):
    """How an image file's stored numbers came from amplitudes; arrays are always linear.

    parameter: dB per unit (decibel), exponent (gamma) or b (schlick); offset: dB (decibel);
    full_scale: largest value that the recorder stores, 0: the pixel type's.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_transfer_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {"kind": TransferKind}

    kind: TransferKind = library_default()
    parameter: float = library_default()
    offset: float = library_default()
    full_scale: float = library_default()


@dataclass(kw_only=True)
class Injection(Parameters):
    """How objects are put into the image.

    mode: composite keeps every bit of pixels outside the objects' influence, resynthesise traces
    the whole patch anew; column_rule: column of an echo of several interactions; noise_floor_db:
    noise energy over the local mean seabed energy, below 0, None: estimated from the patch;
    influence_db: level of change over the seabed from which a pixel is the objects'; ray_scale:
    factor on the number of rays; seed: of all random numbers; interactions: surfaces that a path
    may meet, 1...8; estimator: how paths to the source are found; order_energies: whether the
    result keeps the energy of each number of interactions; match_response, match_saturation:
    whether magnitude images lend objects their point response's widths and the amplitude that cuts
    highlights; match_looks: looks averaged in a pixel, 0: estimated.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_injection_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {
        "mode": Mode,
        "column_rule": ColumnRule,
        "estimator": Estimator,
        "match_response": Match,
        "match_saturation": Match,
    }

    mode: Mode = library_default()
    column_rule: ColumnRule = library_default()
    influence_db: float = library_default()
    ray_scale: float = library_default()
    seed: int = library_default()
    interactions: int = library_default()
    estimator: Estimator = library_default()
    order_energies: bool = library_default()
    match_response: Match = library_default()
    match_looks: float = library_default()
    match_saturation: Match = library_default()
    noise_floor_db: Optional[float] = None

    def __post_init__(self) -> None:
        given = self.noise_floor_db
        super().__post_init__()
        self.noise_floor_db = given
        self.order_energies = bool(self.order_energies)

    def _values(self) -> dict[str, Any]:
        values = super()._values()
        values["estimate_noise"] = int(self.noise_floor_db is None)
        if self.noise_floor_db is None:
            del values["noise_floor_db"]
        return values


@dataclass(kw_only=True)
class Synthetic(Parameters):
    """A synthetic seabed: amplitude or complex pixels with K-distributed speckle.

    speckle_shape: shape of the K distribution, math.inf for Rayleigh amplitudes; texture_length_m:
    correlation length of its texture; ripple_contrast: 0...1; ripple_heading_rad: across the
    crests, from along-track towards range; patch_contrast_db, patch_length_m: sediment patches;
    mean_amplitude: rms amplitude of the darker sediment.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_synthetic_params

    rows: int = library_default()
    columns: int = library_default()
    seed: int = library_default()
    complex_pixels: bool = library_default()
    speckle_shape: float = library_default()
    texture_length_m: float = library_default()
    ripple_wavelength_m: float = library_default()
    ripple_contrast: float = library_default()
    ripple_heading_rad: float = library_default()
    patch_contrast_db: float = library_default()
    patch_length_m: float = library_default()
    mean_amplitude: float = library_default()

    def __post_init__(self) -> None:
        super().__post_init__()
        self.complex_pixels = bool(self.complex_pixels)


@dataclass
class Uniform:
    """A swath of rows x columns pixels of unit reflectivity."""

    rows: int
    columns: int


@dataclass
class Recording:
    """A channel of an XTF file: "port", "starboard", its number there, or None for the only one; or
    the array of that name in an HDF5 or MATLAB file, None for the only one."""

    path: PathLike
    channel: Union[str, int, None] = None
    array: Optional[str] = None

    def number(self) -> int:
        """The channel as the library counts them."""
        words: dict[Union[str, int, None], int] = {"port": -1, "starboard": -2, None: -3}
        if self.channel in words:
            return words[self.channel]
        return whole_number("channel", self.channel, 63)


@dataclass(kw_only=True)
class Patch:
    """The part of a swath that is worked on, in whole pixels."""

    first_row: int
    first_column: int
    rows: int
    columns: int

    def to_structure(self) -> s.sonject_patch_params:
        structure = sized(s.sonject_patch_params)
        fill(structure, {entry.name: getattr(self, entry.name) for entry in fields(self)})
        return structure
