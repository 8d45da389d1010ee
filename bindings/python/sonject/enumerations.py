"""Named choices; the values are those of the C enumerations."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """sonject_status: what a call answered."""

    OK = 0
    ERROR_ARGUMENT = 1
    ERROR_INPUT = 2
    ERROR_DEVICE = 3
    ERROR_STORAGE = 4
    ERROR_MEMORY = 5
    ERROR_UNSUPPORTED = 6
    CANCELLED = 7


class Side(enum.IntEnum):
    """sonject_side: which side of the track the image shows."""

    PORT = 0
    STARBOARD = 1


class TransferKind(enum.IntEnum):
    """sonject_transfer: how stored numbers came from amplitudes."""

    AMPLITUDE = 0
    INTENSITY = 1
    DECIBEL = 2
    GAMMA = 3
    SCHLICK = 4


class Match(enum.IntEnum):
    """sonject_match: taken from the sonar's parameters, or from the image around the objects."""

    NOMINAL = 0
    IMAGE = 1


class LevelKind(enum.IntEnum):
    """sonject_level_kind: what sets the level of an object's echo."""

    PHYSICAL = 0
    TARGET_STRENGTH = 1
    OVER_SEABED = 2


class LabelFormat(enum.IntEnum):
    """sonject_labels: label files that a run writes beside coco.json."""

    YOLO = 1
    VOC = 2


class Mode(enum.IntEnum):
    """sonject_injection_mode: compose into the patch, or trace the whole patch anew."""

    COMPOSITE = 0
    RESYNTHESISE = 1


class ColumnRule(enum.IntEnum):
    """sonject_column_rule: the column of an echo of several interactions."""

    FOCUSED = 0
    PAPER = 1


class Estimator(enum.IntEnum):
    """sonject_estimator: how paths to the source are found."""

    CONNECT = 0
    BRUTE_FORCE = 1


class PulseKind(enum.IntEnum):
    """sonject_pulse_kind: what a point looks like in range."""

    GAUSSIAN = 0
    CHIRP = 1
    TABLE = 2


class PulseWindow(enum.IntEnum):
    """sonject_pulse_window: weighting of a chirp's spectrum."""

    RECTANGULAR = 0
    HANN = 1
    TAYLOR = 2


class PulseAxis(enum.IntEnum):
    """sonject_pulse_axis: what the positions of a pulse's samples are."""

    RANGE = 0
    TIME = 1


class ReflectionKind(enum.IntEnum):
    """sonject_reflection_kind: how the reflection coefficient depends on the angle."""

    CONSTANT = 0
    FLUID = 1


class Shape(enum.IntEnum):
    """sonject_shape."""

    PLANE = 0
    SPHERE = 1
    CYLINDER = 2
    CAPSULE = 3
    DISC = 4
    ELLIPSOID = 5
    BOX = 6
    WEDGE = 7
    CONE = 8
    TRUNCATED_CONE = 9
    TORUS = 10
    PARTS = 11
    MESH = 12
    USER = 13


class End(enum.IntEnum):
    """sonject_end: how a cylinder ends. With an open end it is a tube with a thin wall."""

    FLAT = 0
    OPEN = 1
    SPHERICAL = 2


class BurialKind(enum.IntEnum):
    """sonject_burial_kind: which value says how deep an object lies."""

    DEPTH = 0
    FRACTION = 1
    PROUD = 2


class PositionKind(enum.IntEnum):
    """sonject_position_kind."""

    PATCH_CENTRE = 0
    METRES = 1
    PIXELS = 2


class PixelKind(enum.IntEnum):
    """sonject_pixel_kind."""

    AMPLITUDE = 0
    COMPLEX = 1


class Layer(enum.IntEnum):
    """sonject_layer: the arrays of a result."""

    IMAGE = 0
    FIELD = 1
    ENERGY = 2
    VISIBILITY = 3
    HIGHLIGHT = 4
    SHADOW = 5
    LABELS = 6
    INFLUENCE = 7


class RangeAxis(enum.IntEnum):
    """sonject_range_axis: horizontal axis of a quick look."""

    SLANT = 0
    GROUND = 1


class Samples(enum.IntEnum):
    """sonject_samples: types of samples that a conversion makes."""

    KEPT = 0
    UINT8 = 1
    UINT16 = 2
    FLOAT32 = 3


class ConvertAxis(enum.IntEnum):
    """sonject_convert_axis: range axis that a conversion makes."""

    KEPT = 0
    SLANT = 1
    GROUND = 2


class InputKind(enum.IntEnum):
    """sonject_input_kind: where a scene's swath comes from."""

    MEMORY = 0
    FILE = 1
    UNIFORM = 2
    SYNTHETIC = 3


class SeabedMap(enum.IntEnum):
    """sonject_seabed_map: what resynthesise uses as reflectivity."""

    INTENSITY = 0
    DESPECKLED = 1
    COHERENT = 2


class ForwardRule(enum.IntEnum):
    """sonject_forward_rule: what scatters sound at the seabed that does not go straight back."""

    MODEL = 0
    MAP = 1


class SeriesForm(enum.IntEnum):
    """Of time series: complex baseband, or real passband."""

    BASEBAND = 0
    PASSBAND = 1


class SeriesPulse(enum.IntEnum):
    """Of time series: the image's compressed pulse, or the chirp as transmitted."""

    COMPRESSED = 0
    CHIRP = 1


class ResponseWindow(enum.IntEnum):
    """sonject_response_window: weighting of the aspects that form a pixel."""

    RECTANGULAR = 0
    HAMMING = 1
    TAYLOR = 2


class SonarKind(enum.IntEnum):
    """sonject_sonar_kind: how the image gets its resolution along the track."""

    SYNTHETIC = 0
    REAL = 1
