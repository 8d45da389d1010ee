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

from ._library import load as _load
from ._classes import (
    Box, CampaignImage, ContactMeasures, Device, ElementLayout, Elements, Geometry, Injection,
    Material, Measurement, Medium, Motion, ObjectTruth, Patch, Pulse, Seabed, Sonar, Statistics,
    Surface, Synthetic, Transfer,
)
from .actions import (
    check, convert, element_layout, element_series, form, inject, measure, measure_contact,
    merge, quicklook, run, run_elements, trace, write_seabed,
)
from .campaign import Campaign, merge_campaign
from .context import Context, Progress, default_context, devices
from .enumerations import (
    ColumnRule, ConvertAxis, End, Estimator, ForwardRule, LabelFormat, LevelKind, Match, Mode,
    PulseKind, PulseWindow, RangeAxis, ReflectionKind, ResponseWindow, Samples, SeabedMap,
    SeriesForm, SeriesPulse, Side, SonarKind, Status, TransferKind,
)
from .errors import Cancelled, SonjectError
from .objects import (
    Capsule, Cone, Cuboid, Cut, Cylinder, Disc, Ellipsoid, Mesh, Metres, Object, Part, Parts,
    PatchCentre, Pixels, Plane, Sphere, Target, Torus, TruncatedCone, UserShape, Wedge,
)
from .parameters import Recording, Uniform, absorption, from_degrees
from .result import Result
from .scene import Scene


def version() -> str:
    """major.minor.patch of the loaded library."""
    return str(_load().sonject_version().decode("ascii"))


__all__ = [
    "Box", "Campaign", "CampaignImage", "Cancelled", "Capsule", "ColumnRule", "Cone",
    "ContactMeasures", "Context", "ConvertAxis", "Cuboid", "Cut", "Cylinder", "Device", "Disc",
    "ElementLayout", "Elements", "Ellipsoid", "End", "Estimator", "ForwardRule", "Geometry",
    "Injection", "LabelFormat", "LevelKind", "Match", "Material", "Measurement", "Medium",
    "Mesh", "Metres", "Mode", "Motion", "Object", "ObjectTruth", "Part", "Parts", "Patch",
    "PatchCentre", "Pixels", "Plane", "Progress", "Pulse", "PulseKind", "PulseWindow",
    "RangeAxis", "Recording", "ReflectionKind", "ResponseWindow", "Result", "Samples", "Scene",
    "Seabed", "SeabedMap", "SeriesForm", "SeriesPulse", "Side", "Sonar", "SonarKind",
    "SonjectError", "Sphere", "Statistics", "Status", "Surface", "Synthetic", "Target", "Torus",
    "Transfer", "TransferKind", "TruncatedCone", "Uniform", "UserShape", "Wedge", "absorption",
    "check", "convert", "default_context", "devices", "element_layout", "element_series",
    "form", "from_degrees", "inject", "measure", "measure_contact", "merge", "merge_campaign",
    "quicklook", "run", "run_elements", "trace", "version", "write_seabed",
]
