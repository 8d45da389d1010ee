"""What describes a scene, apart from its objects. SI units, angles in radians.

Whatever is not given takes the library's default, which the attribute shows afterwards. Ranges of
values are checked by the library when a scene is made of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Optional, Union

from . import _interface as s
from ._classes import Elements as Elements
from ._classes import Geometry as Geometry
from ._classes import Injection as Injection
from ._classes import Material as Material
from ._classes import Medium as Medium
from ._classes import Motion as Motion
from ._classes import Patch as Patch
from ._classes import Pulse as Pulse
from ._classes import Seabed as Seabed
from ._classes import Sonar as Sonar
from ._classes import Surface as Surface
from ._classes import Synthetic as Synthetic
from ._classes import Transfer as Transfer
from ._library import load
from ._values import PathLike, real_number, whole_number


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
        words: dict[Union[str, int, None], int] = {
            "port": s.CHANNEL_PORT,
            "starboard": s.CHANNEL_STARBOARD,
            None: s.CHANNEL_ONLY,
        }
        if self.channel in words:
            return words[self.channel]
        return whole_number("channel", self.channel, 63)
