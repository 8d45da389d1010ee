"""The sonar: its beam, pulse, motion and hydrophones."""

from __future__ import annotations

from ctypes import Structure, c_double, c_uint32, c_uint64

from ._capacities import SWAYS_CAPACITY, YAWS_CAPACITY


class sonject_sonar_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("response_window", c_uint32),
        ("centre_frequency_hz", c_double),
        ("bandwidth_hz", c_double),
        ("altitude_m", c_double),
        ("along_track_resolution_m", c_double),
        ("transducer_side_m", c_double),
        ("taylor_sidelobe_db", c_double),
        ("taylor_terms", c_uint32),
        ("kind", c_uint32),
        ("aperture_rad", c_double),
        ("array_length_m", c_double),
        ("array_height_m", c_double),
        ("array_heading_rad", c_double),
        ("array_pitch_rad", c_double),
        ("array_depression_rad", c_double),
    ]


class sonject_pulse_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("window", c_uint32),
        ("taylor_terms", c_uint32),
        ("taylor_sidelobe_db", c_double),
    ]


class sonject_sway(Structure):
    _fields_ = [
        ("amplitude_m", c_double),
        ("wavelength_m", c_double),
        ("phase_rad", c_double),
    ]


class sonject_yaw(Structure):
    _fields_ = [
        ("amplitude_rad", c_double),
        ("wavelength_m", c_double),
        ("phase_rad", c_double),
    ]


class sonject_motion_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("sway_count", c_uint32),
        ("sways", sonject_sway * SWAYS_CAPACITY),
        ("random_rms_m", c_double),
        ("random_correlation_m", c_double),
        ("seed", c_uint64),
        ("yaw_advance_m", c_double),
        ("yaw_bias_rad", c_double),
        ("yaw_random_rms_rad", c_double),
        ("yaw_random_correlation_m", c_double),
        ("yaw_seed", c_uint64),
        ("yaw_count", c_uint32),
        ("reserved", c_uint32),
        ("yaws", sonject_yaw * YAWS_CAPACITY),
    ]


class sonject_elements_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("form", c_uint32),
        ("pulse", c_uint32),
        ("hydrophones", c_uint32),
        ("pings", c_uint32),
        ("reserved", c_uint32),
        ("first_ping_m", c_double),
        ("ping_spacing_m", c_double),
        ("transmitter_offset_m", c_double),
        ("transmitter_length_m", c_double),
        ("first_hydrophone_m", c_double),
        ("hydrophone_spacing_m", c_double),
        ("hydrophone_length_m", c_double),
        ("sampling_rate_hz", c_double),
        ("first_time_s", c_double),
        ("last_time_s", c_double),
        ("chirp_duration_s", c_double),
        ("aspect_limit_rad", c_double),
        ("source_level_db", c_double),
    ]


class sonject_element_layout(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("elements", sonject_elements_params),
        ("samples", c_uint64),
        ("sound_speed_mps", c_double),
        ("centre_frequency_hz", c_double),
        ("bandwidth_hz", c_double),
        ("along_track_resolution_m", c_double),
    ]
