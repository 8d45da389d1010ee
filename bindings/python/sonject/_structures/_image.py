"""Pixels, where they lie, and what is done with image files."""

from __future__ import annotations

from ctypes import Structure, c_char_p, c_double, c_int32, c_uint32, c_uint64, c_void_p


class sonject_geometry_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("side", c_uint32),
        ("row_spacing_m", c_double),
        ("column_spacing_m", c_double),
        ("first_along_track_m", c_double),
        ("first_slant_range_m", c_double),
    ]


class sonject_transfer_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("parameter", c_double),
        ("offset", c_double),
        ("full_scale", c_double),
    ]


class sonject_synthetic_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("complex_pixels", c_uint32),
        ("rows", c_uint32),
        ("columns", c_uint32),
        ("seed", c_uint64),
        ("speckle_shape", c_double),
        ("texture_length_m", c_double),
        ("ripple_wavelength_m", c_double),
        ("ripple_contrast", c_double),
        ("ripple_heading_rad", c_double),
        ("patch_contrast_db", c_double),
        ("patch_length_m", c_double),
        ("mean_amplitude", c_double),
    ]


class sonject_patch_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("first_row", c_uint64),
        ("first_column", c_uint64),
        ("rows", c_uint64),
        ("columns", c_uint64),
    ]


class sonject_pixels(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("rows", c_uint64),
        ("columns", c_uint64),
        ("row_stride", c_uint64),
        ("data", c_void_p),
    ]


class sonject_box(Structure):
    _fields_ = [
        ("first_row", c_uint64),
        ("first_column", c_uint64),
        ("rows", c_uint64),
        ("columns", c_uint64),
    ]


class sonject_quicklook_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("range_axis", c_uint32),
        ("image", c_char_p),
        ("picture", c_char_p),
        ("minimum_db", c_double),
        ("maximum_db", c_double),
        ("altitude_m", c_double),
        ("has_geometry", c_uint32),
        ("has_transfer", c_uint32),
        ("geometry", sonject_geometry_params),
        ("transfer", sonject_transfer_params),
        ("channel", c_int32),
        ("reserved", c_uint32),
        ("array", c_char_p),
    ]


class sonject_convert_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("channel", c_int32),
        ("input", c_char_p),
        ("output", c_char_p),
        ("into", c_char_p),
        ("array", c_char_p),
        ("samples", c_uint32),
        ("magnitude", c_uint32),
        ("scale", c_double),
        ("range_axis", c_uint32),
        ("has_geometry", c_uint32),
        ("geometry", sonject_geometry_params),
        ("altitude_m", c_double),
    ]
