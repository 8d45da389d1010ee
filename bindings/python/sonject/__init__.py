"""Puts ray-traced targets into measured sonar images.

>>> import sonject
>>> scene = sonject.Scene(
...     sonar={"frequency": "100 kHz", "bandwidth": "30 kHz", "altitude": 10},
...     input={"geometry": {"row_spacing": 0.025, "column_spacing": 0.025, "first_slant_range": 40}},
...     objects=[{"shape": "sphere", "diameter": 0.5}],
... )
>>> result = sonject.inject(patch, scene)
>>> result.image

A scene has the keys of scene files. Images are arrays of rows (track positions) x columns (slant
ranges). Results are in m, radians, Hz, as the names of their members say.
"""

from . import keys, plotting
from ._interface import VERSION as _VERSION
from ._library import load as _load
from ._classes import (
    Box, CampaignImage, ContactMeasures, Device, ElementLayout, Measurement, ObjectTruth,
    Statistics,
)
from .actions import (
    absorption, calibrate, check, convert, element_layout, element_series, form, inject, measure,
    measure_contact, merge, quicklook, run, run_elements, trace,
)
from .campaign import Campaign, fit_campaign, merge_campaign
from .context import Context, Progress, default_context, devices
from .enumerations import (
    ConvertAxis, LabelFormat, LabelPart, RangeAxis, SeriesForm, Status,
)
from .errors import Cancelled, SonjectError
from .mesh import write_mesh
from .result import Result
from .scene import Scene
from .transfer import Transfer

__version__ = ".".join(str(part) for part in _VERSION)


def version() -> str:
    """Returns major.minor.patch of the loaded library."""
    return str(_load().sonject_version().decode("ascii"))


__all__ = [
    "Box", "Campaign", "CampaignImage", "Cancelled", "ContactMeasures", "Context", "ConvertAxis",
    "Device", "ElementLayout", "LabelFormat", "LabelPart", "Measurement", "ObjectTruth",
    "Progress", "RangeAxis", "Result", "Scene", "SeriesForm", "SonjectError",
    "Statistics", "Status", "Transfer", "absorption", "calibrate", "check", "convert",
    "default_context", "devices", "element_layout", "element_series", "form", "inject", "keys",
    "fit_campaign", "measure", "measure_contact", "merge", "merge_campaign", "quicklook", "run", "run_elements", "trace",
    "version", "write_mesh",
]
