"""What is done: injections, runs, their stages, campaigns."""

from __future__ import annotations

from ctypes import POINTER, Structure, c_char, c_char_p, c_double, c_uint32, c_uint64

from ._capacities import NAME_CAPACITY


class sonject_scene_read_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("allows_user_shapes", c_uint32),
    ]


class sonject_injection_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("mode", c_uint32),
        ("column_rule", c_uint32),
        ("estimate_noise", c_uint32),
        ("noise_floor_db", c_double),
        ("influence_db", c_double),
        ("ray_scale", c_double),
        ("seed", c_uint64),
        ("interactions", c_uint32),
        ("estimator", c_uint32),
        ("order_energies", c_uint32),
        ("match_response", c_uint32),
        ("match_looks", c_double),
        ("match_saturation", c_uint32),
        ("reserved", c_uint32),
    ]


class sonject_run_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("labels", c_uint32),
        ("folder", c_char_p),
        ("shard_index", c_uint32),
        ("shard_count", c_uint32),
        ("exit_after_s", c_double),
        ("checkpoint_s", c_double),
        ("overwrites", c_uint32),
        ("reserved", c_uint32),
    ]


class sonject_merge_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("allows_user_shapes", c_uint32),
        ("folder", c_char_p),
        ("labels", c_uint32),
        ("reserved", c_uint32),
    ]


class sonject_trace_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("file", c_char_p),
        ("export_file", c_char_p),
    ]


class sonject_form_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("override_count", c_uint32),
        ("file", c_char_p),
        ("folder", c_char_p),
        ("overrides", POINTER(c_char_p)),
        ("allows_user_shapes", c_uint32),
        ("labels", c_uint32),
        ("overwrites", c_uint32),
        ("reserved", c_uint32),
    ]


class sonject_campaign_read_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("allows_user_shapes", c_uint32),
    ]


class sonject_campaign_image(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("object_count", c_uint32),
        ("id", c_uint64),
        ("first_row", c_uint64),
        ("first_column", c_uint64),
        ("rows", c_uint64),
        ("columns", c_uint64),
        ("seed", c_uint64),
        ("swath", c_uint32),
        ("has_target", c_uint32),
        ("split", c_char * NAME_CAPACITY),
        ("class_name", c_char * NAME_CAPACITY),
    ]


class sonject_campaign_run_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("shard_index", c_uint32),
        ("shard_count", c_uint32),
        ("only_one", c_uint32),
        ("only", c_uint64),
        ("folder", c_char_p),
        ("exit_after_s", c_double),
        ("overwrites", c_uint32),
        ("reserved", c_uint32),
    ]
