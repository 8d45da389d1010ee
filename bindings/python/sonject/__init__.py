"""Puts ray-traced targets into measured sonar images.

>>> import sonject
>>> scene = sonject.Scene(
...     geometry=sonject.Geometry(first_slant_range_m=40.0),
...     objects=[sonject.Sphere(diameter_m=0.5)],
... )
>>> result = sonject.inject(patch, scene)
>>> result.image

Lengths are metres, angles radians (from_degrees converts), frequencies hertz. Images are arrays of
rows (track positions) x columns (slant ranges).
"""

from ._callbacks import Progress
from ._library import load as _load
from .actions import check, convert, form, inject, measure, quicklook, run, trace, write_seabed
from .campaign import Campaign, CampaignImage, merge_campaign
from .context import Context, Device, default_context, devices
from ._elements import Elements
from .elements import ElementLayout, element_layout, element_series, run_elements
from .enumerations import (
    ColumnRule,
    ConvertAxis,
    End,
    Estimator,
    ForwardRule,
    LabelFormat,
    LevelKind,
    Match,
    Mode,
    PulseKind,
    PulseWindow,
    RangeAxis,
    ReflectionKind,
    ResponseWindow,
    Samples,
    SeabedMap,
    SeriesForm,
    SeriesPulse,
    Side,
    SonarKind,
    Status,
    TransferKind,
)
from .errors import Cancelled, SonjectError
from .material import Material
from .objects import (
    Capsule,
    Cone,
    Cuboid,
    Cut,
    Cylinder,
    Disc,
    Ellipsoid,
    Metres,
    Object,
    Part,
    Mesh,
    Parts,
    PatchCentre,
    Pixels,
    Plane,
    Sphere,
    Target,
    Torus,
    TruncatedCone,
    UserShape,
    Wedge,
)
from .parameters import (
    Geometry,
    Injection,
    Medium,
    Motion,
    Patch,
    Pulse,
    Recording,
    Seabed,
    Surface,
    Sonar,
    Synthetic,
    Transfer,
    Uniform,
    absorption,
    from_degrees,
)
from .result import Box, Measurement, ObjectTruth, Result, Statistics
from .scene import Scene


def version() -> str:
    """major.minor.patch of the loaded library."""
    return str(_load().sonject_version().decode("ascii"))


__all__ = [
    "Box",
    "Campaign",
    "CampaignImage",
    "Cancelled",
    "Capsule",
    "ColumnRule",
    "Cone",
    "Context",
    "ConvertAxis",
    "Cuboid",
    "Cut",
    "Cylinder",
    "Device",
    "Disc",
    "ElementLayout",
    "Elements",
    "Ellipsoid",
    "End",
    "Estimator",
    "ForwardRule",
    "Geometry",
    "Injection",
    "LabelFormat",
    "LevelKind",
    "Match",
    "Material",
    "Measurement",
    "Medium",
    "Metres",
    "Mode",
    "Motion",
    "Object",
    "ObjectTruth",
    "Part",
    "Mesh",
    "Parts",
    "Patch",
    "PatchCentre",
    "Pixels",
    "Plane",
    "Pulse",
    "PulseKind",
    "PulseWindow",
    "Progress",
    "RangeAxis",
    "Recording",
    "ReflectionKind",
    "ResponseWindow",
    "Result",
    "Samples",
    "Scene",
    "Seabed",
    "SeabedMap",
    "SeriesForm",
    "SeriesPulse",
    "Side",
    "SonarKind",
    "Sonar",
    "SonjectError",
    "Sphere",
    "Statistics",
    "Status",
    "Surface",
    "Synthetic",
    "Target",
    "Torus",
    "Transfer",
    "TransferKind",
    "TruncatedCone",
    "Uniform",
    "UserShape",
    "Wedge",
    "absorption",
    "check",
    "convert",
    "default_context",
    "devices",
    "element_layout",
    "element_series",
    "form",
    "from_degrees",
    "inject",
    "measure",
    "merge_campaign",
    "quicklook",
    "run",
    "run_elements",
    "trace",
    "version",
    "write_seabed",
]
