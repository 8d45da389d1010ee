"""What sound meets besides objects: water, seabed, surface; materials."""

from __future__ import annotations

from ctypes import Structure, c_char_p, c_double, c_uint32

from ._image import sonject_geometry_params, sonject_synthetic_params
from ._sonar import sonject_sonar_params


class sonject_material_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reflection_kind", c_uint32),
        ("reflection", c_double),
        ("roughness_m", c_double),
        ("lambert", c_double),
        ("lambert_exponent", c_double),
        ("glossy_albedo", c_double),
        ("glossy_slope", c_double),
        ("density_ratio", c_double),
        ("speed_ratio", c_double),
        ("loss", c_double),
    ]


class sonject_medium_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("sound_speed_mps", c_double),
        ("reference_sound_speed_mps", c_double),
        ("absorption_db_per_m", c_double),
    ]


class sonject_seabed_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("map", c_uint32),
        ("lambert", c_double),
        ("level_radius_m", c_double),
        ("despeckle_radius_m", c_double),
        ("forward_rule", c_uint32),
        ("reserved", c_uint32),
        ("forward", sonject_material_params),
    ]


class sonject_relief_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("rows", c_uint32),
        ("columns", c_uint32),
        ("reserved", c_uint32),
        ("first_along_track_m", c_double),
        ("first_ground_range_m", c_double),
        ("row_spacing_m", c_double),
        ("column_spacing_m", c_double),
    ]


class sonject_surface_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("water_depth_m", c_double),
        ("material", sonject_material_params),
    ]


class sonject_seabed_file_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("image", c_char_p),
        ("synthetic", sonject_synthetic_params),
        ("geometry", sonject_geometry_params),
        ("sonar", sonject_sonar_params),
    ]
