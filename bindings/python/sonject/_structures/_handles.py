"""Contexts, and what is made with them."""

from __future__ import annotations

from ctypes import CFUNCTYPE, Structure, c_char, c_char_p, c_double, c_int, c_uint32, c_void_p

sonject_log_function = CFUNCTYPE(None, c_void_p, c_char_p)
sonject_progress_function = CFUNCTYPE(c_int, c_void_p, c_double, c_char_p)


class sonject_context(Structure):
    """Opaque."""


class sonject_scene(Structure):
    """Opaque."""


class sonject_result(Structure):
    """Opaque."""


class sonject_campaign(Structure):
    """Opaque."""


class sonject_context_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("device_name", c_char_p),
        ("opencl_context", c_void_p),
        ("opencl_device", c_void_p),
        ("log", sonject_log_function),
        ("log_user", c_void_p),
        ("decodes_in_process", c_uint32),
        ("reserved_end", c_uint32),
    ]


class sonject_device_info(Structure):
    _fields_ = [
        ("name", c_char * 128),
        ("platform", c_char * 128),
        ("driver", c_char * 128),
        ("compute_units", c_uint32),
        ("vector_width", c_uint32),
        ("is_default", c_uint32),
        ("reserved", c_uint32),
    ]
