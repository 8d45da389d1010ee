"""The array of the element level."""

from __future__ import annotations

import ctypes
import enum
from dataclasses import dataclass
from typing import ClassVar, Mapping, Type

from . import _structures as s
from ._parameters import Parameters, library_default
from .enumerations import SeriesForm, SeriesPulse


@dataclass(kw_only=True)
class Elements(Parameters):
    """A transmitter and hydrophones on the track, ping by ping; it stands still from ping to echo.

    form, pulse: of the series; hydrophones, pings: counts, 0 pings: as many as see the patch's
    whole aperture; first_ping_m: the array's origin at ping 0, NaN: the pings are about the patch;
    ping_spacing_m: 0: half the array; transmitter_..., hydrophone_...: offsets from the origin and
    lengths, NaN: about the origin, and twice the along-track resolution (length 0: a point);
    hydrophone_spacing_m: 0: the length; sampling_rate_hz: 0: twice the bandwidth, in pass band
    twice the frequency more; first_time_s, last_time_s: of the samples after transmission, NaN:
    what the patch needs; aspect_limit_rad: echoes further off abeam are left out, 0: none;
    source_level_db: rms over 1 uPa at 1 m: series are pressures in Pa, less absorption; NaN: they
    are ratios to the source's pressure at 1 m.
    """

    _structure: ClassVar[Type[ctypes.Structure]] = s.sonject_elements_params
    _choices: ClassVar[Mapping[str, Type[enum.IntEnum]]] = {
        "form": SeriesForm,
        "pulse": SeriesPulse,
    }

    form: SeriesForm = library_default()
    pulse: SeriesPulse = library_default()
    hydrophones: int = library_default()
    pings: int = library_default()
    first_ping_m: float = library_default()
    ping_spacing_m: float = library_default()
    transmitter_offset_m: float = library_default()
    transmitter_length_m: float = library_default()
    first_hydrophone_m: float = library_default()
    hydrophone_spacing_m: float = library_default()
    hydrophone_length_m: float = library_default()
    sampling_rate_hz: float = library_default()
    first_time_s: float = library_default()
    last_time_s: float = library_default()
    chirp_duration_s: float = library_default()
    aspect_limit_rad: float = library_default()
    source_level_db: float = library_default()
