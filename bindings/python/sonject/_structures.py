"""The public structures of include/sonject, field by field and under their C names.

tests/test_declarations.py compares them with the headers and with the C compiler's layout.
"""

from __future__ import annotations

from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_char,
    c_char_p,
    c_double,
    c_int32,
    c_int,
    c_int32,
    c_uint32,
    c_uint64,
    c_void_p,
)

NAME_CAPACITY = 64
CUTS_CAPACITY = 2
SWAYS_CAPACITY = 8
YAWS_CAPACITY = 8
USER_PARAMETERS_CAPACITY = 16

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
    ]


class sonject_context_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("device_name", c_char_p),
        ("cache_folder", c_char_p),
        ("opencl_context", c_void_p),
        ("opencl_device", c_void_p),
        ("log", sonject_log_function),
        ("log_user", c_void_p),
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


class sonject_scene_read_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("allows_user_shapes", c_uint32),
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


class sonject_object_truth(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("is_visible", c_uint32),
        ("highlight_is_cut", c_uint32),
        ("shadow_is_cut", c_uint32),
        ("row", c_double),
        ("column", c_double),
        ("along_track_m", c_double),
        ("slant_range_m", c_double),
        ("ground_range_m", c_double),
        ("height_m", c_double),
        ("highlight", sonject_box),
        ("shadow", sonject_box),
        ("both", sonject_box),
        ("highlight_pixels", c_uint64),
        ("shadow_pixels", c_uint64),
        ("target_strength_db", c_double),
        ("highlight_contrast_db", c_double),
        ("shadow_contrast_db", c_double),
        ("burial_m", c_double),
        ("grazing_rad", c_double),
        ("transmission_loss_db", c_double),
        ("level_kind", c_uint32),
        ("reserved", c_uint32),
        ("level_gain_db", c_double),
        ("over_seabed_db", c_double),
        ("seabed_strength_db", c_double),
        ("highlight_visible", c_double),
        ("shadow_visible", c_double),
        ("overall_length_m", c_double),
        ("overall_width_m", c_double),
        ("overall_height_m", c_double),
    ]


class sonject_statistics(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("pings", c_uint64),
        ("rays", c_uint64),
        ("ray_queries", c_uint64),
        ("impulses", c_uint64),
        ("trace_s", c_double),
        ("form_s", c_double),
        ("inject_s", c_double),
        ("noise_floor_db", c_double),
        ("input_clipped", c_uint64),
        ("output_clipped", c_uint64),
        ("changed_pixels", c_uint64),
        ("level_change_db", c_double),
        ("input_contrast", c_double),
        ("output_contrast", c_double),
        ("histogram_distance", c_double),
        ("correlation", c_double),
        ("seabed_amplitude_contrast", c_double),
        ("seabed_shape", c_double),
        ("seabed_looks", c_double),
        ("seabed_row_correlation", c_double),
        ("seabed_column_correlation", c_double),
        ("along_track_resolution_m", c_double),
        ("range_resolution_m", c_double),
        ("looks", c_double),
        ("saturation_amplitude", c_double),
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


class sonject_run_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("labels", c_uint32),
        ("folder", c_char_p),
        ("shard_index", c_uint32),
        ("shard_count", c_uint32),
        ("exit_after_s", c_double),
        ("checkpoint_s", c_double),
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
    ]


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


class sonject_surface_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("water_depth_m", c_double),
        ("material", sonject_material_params),
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


class sonject_measure_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("has_transfer", c_uint32),
        ("image", c_char_p),
        ("before", c_char_p),
        ("influence", c_char_p),
        ("labels", c_char_p),
        ("transfer", sonject_transfer_params),
    ]


class sonject_measurement(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("amplitude_contrast", c_double),
        ("intensity_contrast", c_double),
        ("looks", c_double),
        ("shape", c_double),
        ("row_correlation", c_double),
        ("column_correlation", c_double),
        ("row_length_pixels", c_double),
        ("column_length_pixels", c_double),
        ("seam", c_double),
        ("seam_error", c_double),
        ("seam_before", c_double),
        ("seam_patches", c_uint64),
        ("background_patches", c_uint64),
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


class sonject_contact_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("box", sonject_box),
        ("row_spacing_m", c_double),
        ("column_spacing_m", c_double),
    ]


class sonject_contact_measures(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("highlight", sonject_box),
        ("shadow", sonject_box),
        ("highlight_along_pixels", c_double),
        ("highlight_range_pixels", c_double),
        ("shadow_along_pixels", c_double),
        ("shadow_range_pixels", c_double),
        ("highlight_along_m", c_double),
        ("highlight_range_m", c_double),
        ("shadow_along_m", c_double),
        ("shadow_range_m", c_double),
        ("axis_length_m", c_double),
        ("axis_width_m", c_double),
        ("axis_rad", c_double),
        ("highlight_db", c_double),
        ("shadow_db", c_double),
        ("seabed_db", c_double),
        ("highlight_contrast_db", c_double),
        ("shadow_contrast_db", c_double),
        ("seabed_shape", c_double),
        ("seabed_looks", c_double),
        ("row_length_pixels", c_double),
        ("column_length_pixels", c_double),
    ]


class sonject_contact_file_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("has_transfer", c_uint32),
        ("image", c_char_p),
        ("truth", c_char_p),
        ("boxes", POINTER(sonject_box)),
        ("box_count", c_uint32),
        ("reserved", c_uint32),
        ("row_spacing_m", c_double),
        ("column_spacing_m", c_double),
        ("transfer", sonject_transfer_params),
    ]
