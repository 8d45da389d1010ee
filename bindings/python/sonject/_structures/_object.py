"""Objects and their shapes."""

from __future__ import annotations

from ctypes import Structure, c_char, c_char_p, c_double, c_int32, c_uint32

from ._capacities import CUTS_CAPACITY, NAME_CAPACITY, USER_PARAMETERS_CAPACITY
from ._sea import sonject_material_params


class sonject_cut(Structure):
    _fields_ = [
        ("azimuth_rad", c_double),
        ("elevation_rad", c_double),
        ("distance_m", c_double),
    ]


class sonject_object_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("shape", c_uint32),
        ("name", c_char * NAME_CAPACITY),
        ("class_name", c_char * NAME_CAPACITY),
        ("length_m", c_double),
        ("width_m", c_double),
        ("diameter_m", c_double),
        ("position_kind", c_uint32),
        ("burial_kind", c_uint32),
        ("position_along", c_double),
        ("position_range", c_double),
        ("heading_rad", c_double),
        ("pitch_rad", c_double),
        ("roll_rad", c_double),
        ("burial_m", c_double),
        ("material", sonject_material_params),
        ("height_m", c_double),
        ("top_diameter_m", c_double),
        ("front_height_m", c_double),
        ("nose_end", c_uint32),
        ("tail_end", c_uint32),
        ("nose_end_depth_m", c_double),
        ("tail_end_depth_m", c_double),
        ("burial_fraction", c_double),
        ("proud_height_m", c_double),
        ("cut_count", c_uint32),
        ("mesh", c_uint32),
        ("cuts", sonject_cut * CUTS_CAPACITY),
        ("user_shape", c_uint32),
        ("level_kind", c_uint32),
        ("level_db", c_double),
    ]


class sonject_part_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("along_m", c_double),
        ("across_m", c_double),
        ("up_m", c_double),
        ("heading_rad", c_double),
        ("pitch_rad", c_double),
        ("roll_rad", c_double),
    ]


class sonject_mesh_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("allows_open", c_uint32),
        ("unit_m", c_double),
        ("axes", c_int32 * 3),
        ("reserved", c_int32),
        ("smooth_angle_rad", c_double),
    ]


class sonject_user_shape_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("is_open", c_uint32),
        ("name", c_char_p),
        ("code", c_char_p),
        ("bounding_radius_m", c_double),
        ("half_length_m", c_double),
        ("half_width_m", c_double),
        ("half_height_m", c_double),
        ("first_line", c_uint32),
        ("parameter_count", c_uint32),
        ("parameters", c_double * USER_PARAMETERS_CAPACITY),
    ]
