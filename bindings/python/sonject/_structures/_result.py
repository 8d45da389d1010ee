"""What is learnt: truth, statistics, measures."""

from __future__ import annotations

from ctypes import POINTER, Structure, c_char_p, c_double, c_int32, c_uint32, c_uint64

from ._image import sonject_box, sonject_transfer_params


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
        ("highlight_along_m", c_double),
        ("highlight_range_m", c_double),
        ("shadow_along_m", c_double),
        ("shadow_range_m", c_double),
        ("gap_range_m", c_double),
        ("dim_range_m", c_double),
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


class sonject_measure_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("has_transfer", c_uint32),
        ("image", c_char_p),
        ("before", c_char_p),
        ("influence", c_char_p),
        ("labels", c_char_p),
        ("transfer", sonject_transfer_params),
        ("channel", c_int32),
        ("reserved", c_uint32),
        ("array", c_char_p),
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
        ("is_cut", c_uint32),
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
        ("gap_range_pixels", c_double),
        ("gap_range_m", c_double),
        ("dim_range_pixels", c_double),
        ("dim_range_m", c_double),
        ("highlight_along_error_pixels", c_double),
        ("highlight_range_error_pixels", c_double),
        ("shadow_along_error_pixels", c_double),
        ("shadow_range_error_pixels", c_double),
        ("gap_range_error_pixels", c_double),
        ("dim_range_error_pixels", c_double),
        ("box", sonject_box),
    ]


class sonject_contact_file_params(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("has_transfer", c_uint32),
        ("image", c_char_p),
        ("truth", c_char_p),
        ("boxes", POINTER(sonject_box)),
        ("box_count", c_uint32),
        ("find_most", c_uint32),
        ("row_spacing_m", c_double),
        ("column_spacing_m", c_double),
        ("transfer", sonject_transfer_params),
        ("find_contrast_db", c_double),
        ("channel", c_int32),
        ("reserved", c_uint32),
        ("array", c_char_p),
    ]
