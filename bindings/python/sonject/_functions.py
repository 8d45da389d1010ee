"""Parameters and results of every public function, checked against the headers by the tests."""

from __future__ import annotations

import ctypes
from ctypes import (
    POINTER,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int32,
    c_size_t,
    c_uint8,
    c_uint32,
    c_uint64,
    c_void_p,
)
from typing import Any

from . import _structures as s

_status = c_int
_context = POINTER(s.sonject_context)
_scene = POINTER(s.sonject_scene)
_result = POINTER(s.sonject_result)
_campaign = POINTER(s.sonject_campaign)

# name: (what it returns, its parameters in order)
FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "sonject_version": (c_char_p, []),
    "sonject_status_name": (c_char_p, [_status]),
    "sonject_context_params_init": (None, [POINTER(s.sonject_context_params)]),
    "sonject_context_create": (_status, [POINTER(s.sonject_context_params), POINTER(_context)]),
    "sonject_context_release": (None, [POINTER(_context)]),
    "sonject_context_message": (c_char_p, [_context]),
    "sonject_devices": (
        _status,
        [_context, POINTER(s.sonject_device_info), c_size_t, POINTER(c_size_t)],
    ),
    "sonject_contact_params_init": (None, [POINTER(s.sonject_contact_params)]),
    "sonject_contact_file_params_init": (None, [POINTER(s.sonject_contact_file_params)]),
    "sonject_measure_contact": (
        _status,
        [
            _context,
            POINTER(s.sonject_pixels),
            POINTER(s.sonject_contact_params),
            POINTER(s.sonject_contact_measures),
        ],
    ),
    "sonject_measure_contacts": (
        _status,
        [_context, POINTER(s.sonject_contact_file_params), POINTER(c_char_p)],
    ),
    "sonject_compare_contacts": (
        _status,
        [_context, c_char_p, c_char_p, c_char_p, POINTER(c_char_p)],
    ),
    "sonject_geometry_params_init": (None, [POINTER(s.sonject_geometry_params)]),
    "sonject_transfer_params_init": (None, [POINTER(s.sonject_transfer_params)]),
    "sonject_synthetic_params_init": (None, [POINTER(s.sonject_synthetic_params)]),
    "sonject_injection_params_init": (None, [POINTER(s.sonject_injection_params)]),
    "sonject_material_params_init": (None, [POINTER(s.sonject_material_params)]),
    "sonject_material_named": (_status, [c_char_p, POINTER(s.sonject_material_params)]),
    "sonject_material_name": (c_char_p, [c_uint32]),
    "sonject_object_params_init": (None, [POINTER(s.sonject_object_params)]),
    "sonject_mesh_params_init": (None, [POINTER(s.sonject_mesh_params)]),
    "sonject_user_shape_params_init": (None, [POINTER(s.sonject_user_shape_params)]),
    "sonject_scene_read_params_init": (None, [POINTER(s.sonject_scene_read_params)]),
    "sonject_part_params_init": (None, [POINTER(s.sonject_part_params)]),
    "sonject_sonar_params_init": (None, [POINTER(s.sonject_sonar_params)]),
    "sonject_medium_params_init": (None, [POINTER(s.sonject_medium_params)]),
    "sonject_absorption": (c_double, [c_double, c_double, c_double, c_double, c_double]),
    "sonject_seabed_params_init": (None, [POINTER(s.sonject_seabed_params)]),
    "sonject_scene_create": (_status, [_context, POINTER(_scene)]),
    "sonject_scene_read": (
        _status,
        [_context, c_char_p, POINTER(c_char_p), c_size_t, POINTER(_scene)],
    ),
    "sonject_scene_read_with": (
        _status,
        [
            _context,
            c_char_p,
            POINTER(c_char_p),
            c_size_t,
            POINTER(s.sonject_scene_read_params),
            POINTER(_scene),
        ],
    ),
    "sonject_scene_bands": (
        _status,
        [
            _context,
            c_char_p,
            POINTER(c_char_p),
            c_size_t,
            POINTER(c_char_p),
        ],
    ),
    "sonject_scene_release": (None, [POINTER(_scene)]),
    "sonject_scene_set_sonar": (_status, [_scene, POINTER(s.sonject_sonar_params)]),
    "sonject_pulse_params_init": (None, [POINTER(s.sonject_pulse_params)]),
    "sonject_motion_params_init": (None, [POINTER(s.sonject_motion_params)]),
    "sonject_scene_set_pulse": (_status, [_scene, POINTER(s.sonject_pulse_params)]),
    "sonject_scene_set_pulse_table": (
        _status,
        [
            _scene,
            c_uint32,
            POINTER(c_double),
            POINTER(c_double),
            POINTER(c_double),
            c_size_t,
        ],
    ),
    "sonject_scene_set_cross_range_table": (
        _status,
        [_scene, POINTER(c_double), POINTER(c_double), POINTER(c_double), c_size_t],
    ),
    "sonject_scene_set_motion": (_status, [_scene, POINTER(s.sonject_motion_params)]),
    "sonject_scene_set_motion_table": (
        _status,
        [_scene, POINTER(c_double), POINTER(c_double), c_size_t],
    ),
    "sonject_scene_set_yaw_table": (
        _status,
        [_scene, POINTER(c_double), POINTER(c_double), c_size_t],
    ),
    "sonject_surface_params_init": (None, [POINTER(s.sonject_surface_params)]),
    "sonject_scene_set_surface": (_status, [_scene, POINTER(s.sonject_surface_params)]),
    "sonject_scene_set_medium": (_status, [_scene, POINTER(s.sonject_medium_params)]),
    "sonject_scene_set_water_layers": (
        _status,
        [_scene, POINTER(c_double), POINTER(c_double), POINTER(c_double), c_size_t],
    ),
    "sonject_scene_set_sound_speed_profile": (
        _status,
        [_scene, POINTER(c_double), POINTER(c_double), c_size_t],
    ),
    "sonject_scene_set_seabed": (_status, [_scene, POINTER(s.sonject_seabed_params)]),
    "sonject_relief_params_init": (None, [POINTER(s.sonject_relief_params)]),
    "sonject_scene_set_relief": (
        _status,
        [_scene, POINTER(s.sonject_relief_params), POINTER(c_float)],
    ),
    "sonject_scene_set_geometry": (_status, [_scene, POINTER(s.sonject_geometry_params)]),
    "sonject_scene_take_geometry": (_status, [_scene]),
    "sonject_scene_set_transfer": (_status, [_scene, POINTER(s.sonject_transfer_params)]),
    "sonject_scene_set_injection": (_status, [_scene, POINTER(s.sonject_injection_params)]),
    "sonject_scene_set_patch": (_status, [_scene, POINTER(s.sonject_patch_params)]),
    "sonject_scene_set_input_array": (_status, [_scene, c_char_p]),
    "sonject_scene_set_input_channel": (_status, [_scene, c_int32]),
    "sonject_scene_set_input_file": (_status, [_scene, c_char_p]),
    "sonject_scene_set_input_uniform": (_status, [_scene, c_uint32, c_uint32]),
    "sonject_scene_set_input_synthetic": (_status, [_scene, POINTER(s.sonject_synthetic_params)]),
    "sonject_scene_add_object": (
        _status,
        [_scene, POINTER(s.sonject_object_params), POINTER(c_uint32)],
    ),
    "sonject_scene_add_mesh": (
        _status,
        [_scene, c_char_p, POINTER(s.sonject_mesh_params), POINTER(c_uint32)],
    ),
    "sonject_scene_add_user_shape": (
        _status,
        [_scene, POINTER(s.sonject_user_shape_params), POINTER(c_uint32)],
    ),
    "sonject_scene_add_target": (
        _status,
        [
            _scene,
            c_char_p,
            POINTER(s.sonject_scene_read_params),
            POINTER(s.sonject_object_params),
            POINTER(c_uint32),
        ],
    ),
    "sonject_scene_add_part": (
        _status,
        [_scene, c_uint32, POINTER(s.sonject_object_params), POINTER(s.sonject_part_params)],
    ),
    "sonject_scene_object_count": (_status, [_scene, POINTER(c_uint32)]),
    "sonject_inject": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_pixels),
            s.sonject_progress_function,
            c_void_p,
            POINTER(_result),
        ],
    ),
    "sonject_result_release": (None, [POINTER(_result)]),
    "sonject_result_size": (
        _status,
        [_result, POINTER(c_uint64), POINTER(c_uint64), POINTER(c_uint32)],
    ),
    "sonject_result_layer": (_status, [_result, c_int, c_void_p, c_size_t]),
    "sonject_result_order_energy": (_status, [_result, c_uint32, c_void_p, c_size_t]),
    "sonject_result_object": (_status, [_result, c_uint32, POINTER(s.sonject_object_truth)]),
    "sonject_result_statistics": (_status, [_result, POINTER(s.sonject_statistics)]),
    "sonject_run_params_init": (None, [POINTER(s.sonject_run_params)]),
    "sonject_run": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_run_params),
            s.sonject_progress_function,
            c_void_p,
            POINTER(c_int),
        ],
    ),
    "sonject_merge_params_init": (None, [POINTER(s.sonject_merge_params)]),
    "sonject_merge": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_merge_params),
            s.sonject_progress_function,
            c_void_p,
            POINTER(c_int),
        ],
    ),
    "sonject_trace_params_init": (None, [POINTER(s.sonject_trace_params)]),
    "sonject_trace": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_trace_params),
            s.sonject_progress_function,
            c_void_p,
        ],
    ),
    "sonject_form_params_init": (None, [POINTER(s.sonject_form_params)]),
    "sonject_form": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_form_params),
            s.sonject_progress_function,
            c_void_p,
            POINTER(c_int),
        ],
    ),
    "sonject_elements_params_init": (None, [POINTER(s.sonject_elements_params)]),
    "sonject_scene_set_elements": (_status, [_scene, POINTER(s.sonject_elements_params)]),
    "sonject_elements_describe": (
        _status,
        [_context, _scene, c_uint64, c_uint64, POINTER(s.sonject_element_layout)],
    ),
    "sonject_element_series": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_pixels),
            s.sonject_progress_function,
            c_void_p,
            POINTER(c_float),
            c_size_t,
        ],
    ),
    "sonject_elements_run": (
        _status,
        [
            _context,
            _scene,
            POINTER(s.sonject_run_params),
            s.sonject_progress_function,
            c_void_p,
        ],
    ),
    "sonject_campaign_read_params_init": (None, [POINTER(s.sonject_campaign_read_params)]),
    "sonject_campaign_read": (
        _status,
        [
            _context,
            c_char_p,
            POINTER(c_char_p),
            c_size_t,
            POINTER(s.sonject_campaign_read_params),
            POINTER(_campaign),
        ],
    ),
    "sonject_campaign_release": (None, [POINTER(_campaign)]),
    "sonject_campaign_image_count": (_status, [_campaign, POINTER(c_uint64)]),
    "sonject_campaign_describe": (
        _status,
        [_campaign, c_uint64, POINTER(s.sonject_campaign_image)],
    ),
    "sonject_campaign_scene": (_status, [_context, _campaign, c_uint64, POINTER(_scene)]),
    "sonject_campaign_inject": (
        _status,
        [
            _context,
            _campaign,
            c_uint64,
            s.sonject_progress_function,
            c_void_p,
            POINTER(_result),
        ],
    ),
    "sonject_campaign_run_params_init": (None, [POINTER(s.sonject_campaign_run_params)]),
    "sonject_campaign_run": (
        _status,
        [
            _context,
            _campaign,
            POINTER(s.sonject_campaign_run_params),
            s.sonject_progress_function,
            c_void_p,
            POINTER(c_int),
        ],
    ),
    "sonject_campaign_merge": (
        _status,
        [_context, c_char_p, s.sonject_progress_function, c_void_p],
    ),
    "sonject_check": (_status, [_context, _scene, POINTER(c_char_p)]),
    "sonject_text_release": (None, [POINTER(c_char_p)]),
    "sonject_quicklook_params_init": (None, [POINTER(s.sonject_quicklook_params)]),
    "sonject_quicklook": (_status, [_context, POINTER(s.sonject_quicklook_params)]),
    "sonject_convert_params_init": (None, [POINTER(s.sonject_convert_params)]),
    "sonject_convert": (_status, [_context, POINTER(s.sonject_convert_params)]),
    "sonject_seabed_file_params_init": (None, [POINTER(s.sonject_seabed_file_params)]),
    "sonject_measure_params_init": (None, [POINTER(s.sonject_measure_params)]),
    "sonject_measure": (
        _status,
        [_context, POINTER(s.sonject_measure_params), POINTER(s.sonject_measurement)],
    ),
    "sonject_measure_pixels": (
        _status,
        [
            _context,
            POINTER(s.sonject_pixels),
            POINTER(c_uint8),
            POINTER(c_uint8),
            POINTER(s.sonject_measurement),
        ],
    ),
    "sonject_seabed_write": (_status, [_context, POINTER(s.sonject_seabed_file_params)]),
}


def declare(library: ctypes.CDLL) -> None:
    """Sets restype and argtypes. Raises AttributeError where the library lacks a function."""
    for name, (result, parameters) in FUNCTIONS.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = parameters
