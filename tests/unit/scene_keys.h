/* Every key of scene files: a value for it, where that must arrive, and what its section needs
 * then. To be included by files that begin with #define _POSIX_C_SOURCE 200809L. */
#ifndef SCENE_KEYS_H
#define SCENE_KEYS_H

#include <jansson.h>

#include "claims.h"
#include "scene_folder.h"

static const char small[] = "sonject: 1\n"
                            "input:\n"
                            "  uniform: {rows: 4, columns: 5}\n"
                            "  geometry:\n"
                            "    row_spacing: 2.5 cm\n"
                            "    column_spacing: 2.5 cm\n"
                            "    first_slant_range: 40 m\n"
                            "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m, "
                            "transducer: 5 cm}\n"
                            "objects:\n"
                            "  - {shape: sphere, diameter: 0.5 m}\n";

static const char synthetic[] = "sonject: 1\n"
                                "input:\n"
                                "  synthetic: {rows: 4, columns: 5}\n"
                                "  geometry: {row_spacing: 1, column_spacing: 1, "
                                "first_slant_range: 40}\n"
                                "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n";

static const char pinging[] = "sonject: 1\n"
                              "input:\n"
                              "  uniform: {rows: 4, columns: 5}\n"
                              "  geometry: {row_spacing: {speed: 1, ping_rate: 20}, "
                              "column_spacing: 1, first_slant_range: 40}\n"
                              "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n";

static const char banded[] = "sonject: 1\n"
                             "input:\n"
                             "  uniform: {rows: 4, columns: 5}\n"
                             "  geometry: {row_spacing: 1, column_spacing: 1, "
                             "first_slant_range: 40}\n"
                             "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
                             "bands: {low: {}, high: {sonar: {frequency: 400e3}}}\n";

static const char sidescan[] = "sonject: 1\n"
                               "input:\n"
                               "  uniform: {rows: 4, columns: 5}\n"
                               "  geometry: {row_spacing: 1, column_spacing: 1, "
                               "first_slant_range: 40}\n"
                               "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10, "
                               "kind: real, array: {length: 1 m}}\n";

static const char file[] = "sonject: 1\n"
                           "input:\n"
                           "  path: swath.tif\n"
                           "  geometry: {row_spacing: 1, column_spacing: 1, "
                           "first_slant_range: 40}\n"
                           "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n";

static const char casting[] = "sonject: 1\n"
                              "input:\n"
                              "  uniform: {rows: 4, columns: 5}\n"
                              "  geometry: {row_spacing: 1, column_spacing: 1, "
                              "first_slant_range: 40}\n"
                              "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
                              "surface: {depth: 20 m}\n";

enum type {
    TYPE_DOUBLE,
    TYPE_U32,
    TYPE_U64,
    TYPE_BOOL,
    TYPE_TEXT, /* an array of characters */
    TYPE_PATH, /* a pointer to them */
    TYPE_NOTHING
};

/* A value that is not the default, where it must arrive, and what else its section then needs. */
static const struct key_case {
    const char *path;
    const char *base;
    const char *value;
    enum type type;
    size_t offset; /* in struct scene; in the first object if the path starts with objects, in the
                      first part if it goes on with parts, in the first user shape if it goes
                      through user, in the layers if it starts with medium.layers or .profile, in
                      the relief's first feature, or in its grid, if with seabed.relief */
    double number;
    const char *text;
    const char *other;
} cases[] = {
#define SCENE(member)  offsetof(struct scene, member)
#define OBJECT(member) offsetof(sonject_object_params, member)
#define LAYER(index, member)                                                                       \
    ((index) * sizeof(struct water_layer) + offsetof(struct water_layer, member))
#define RELIEF(member) offsetof(struct relief_feature, member)
#define GRID(member)   offsetof(sonject_relief_params, member)
#define YAW            "sonar.motion.yaw={advance: 1}"
#define CAST           SOURCE_ROOT "/tests/unit/cast.csv"
#define HEIGHTS        SOURCE_ROOT "/tests/unit/heights.png"
#define ARRAYS         SOURCE_ROOT "/tests/unit/heights.mat" /* two arrays of 2 x 3 bytes */
    {"sonject", small, "1", TYPE_NOTHING, 0, 0.0, NULL, NULL},
    /* what these two do: test_scene_bands.c */
    {"band", banded, "high", TYPE_NOTHING, 0, 0.0, NULL, NULL},
    {"bands", small, "{low: {}}", TYPE_NOTHING, 0, 0.0, NULL, "band=low"},
    {"input.path", file, "swath-2.tif", TYPE_PATH, SCENE(input_path), 0.0, "swath-2.tif", NULL},
    {"input.channel", file, "5", TYPE_U32, SCENE(channel), 5.0, NULL, NULL},
    {"input.array", file, "swath", TYPE_PATH, SCENE(array), 0.0, "swath", NULL},
    {"input.complex", file, "true", TYPE_BOOL, SCENE(input_is_complex), 1.0, NULL, NULL},
    {"input.uniform.rows", small, "1048576", TYPE_U32, SCENE(uniform_rows), 1048576.0, NULL, NULL},
    {"input.uniform.columns", small, "7", TYPE_U32, SCENE(uniform_columns), 7.0, NULL, NULL},
    {"input.synthetic.rows", synthetic, "8", TYPE_U32, SCENE(synthetic.rows), 8.0, NULL, NULL},
    {"input.synthetic.columns", synthetic, "9", TYPE_U32, SCENE(synthetic.columns), 9.0, NULL,
     NULL},
    {"input.synthetic.seed", synthetic, "4294967296", TYPE_U64, SCENE(synthetic.seed), 4294967296.0,
     NULL, NULL},
    {"input.synthetic.complex", synthetic, "true", TYPE_U32, SCENE(synthetic.complex_pixels), 1.0,
     NULL, NULL},
    {"input.synthetic.speckle_shape", synthetic, "inf", TYPE_DOUBLE, SCENE(synthetic.speckle_shape),
     HUGE_VAL, NULL, NULL},
    {"input.synthetic.texture_length", synthetic, "35 cm", TYPE_DOUBLE,
     SCENE(synthetic.texture_length_m), 0.35, NULL, NULL},
    {"input.synthetic.ripple_wavelength", synthetic, "75 cm", TYPE_DOUBLE,
     SCENE(synthetic.ripple_wavelength_m), 0.75, NULL, NULL},
    {"input.synthetic.ripple_contrast", synthetic, "0.125", TYPE_DOUBLE,
     SCENE(synthetic.ripple_contrast), 0.125, NULL, NULL},
    {"input.synthetic.ripple_heading", synthetic, "90 deg", TYPE_DOUBLE,
     SCENE(synthetic.ripple_heading_rad), PI / 2.0, NULL, NULL},
    {"input.synthetic.patch_contrast", synthetic, "6 dB", TYPE_DOUBLE,
     SCENE(synthetic.patch_contrast_db), 6.0, NULL, NULL},
    {"input.synthetic.patch_length", synthetic, "7 m", TYPE_DOUBLE, SCENE(synthetic.patch_length_m),
     7.0, NULL, NULL},
    {"input.synthetic.mean_amplitude", synthetic, "0.5", TYPE_DOUBLE,
     SCENE(synthetic.mean_amplitude), 0.5, NULL, NULL},
    {"input.geometry.row_spacing", small, "5 cm", TYPE_DOUBLE, SCENE(geometry.row_spacing_m), 0.05,
     NULL, NULL},
    {"input.geometry.row_spacing.speed", pinging, "1.5 m/s", TYPE_DOUBLE,
     SCENE(geometry.row_spacing_m), 0.075, NULL, NULL},
    {"input.geometry.row_spacing.ping_rate", pinging, "16 Hz", TYPE_DOUBLE,
     SCENE(geometry.row_spacing_m), 0.0625, NULL, NULL},
    {"input.geometry.column_spacing", small, "15 mm", TYPE_DOUBLE, SCENE(geometry.column_spacing_m),
     0.015, NULL, NULL},
    {"input.geometry.first_slant_range", small, "0.043 km", TYPE_DOUBLE,
     SCENE(geometry.first_slant_range_m), 43.0, NULL, NULL},
    {"input.geometry.first_along_track", small, "-3 m", TYPE_DOUBLE,
     SCENE(geometry.first_along_track_m), -3.0, NULL, NULL},
    {"input.geometry.side", small, "starboard", TYPE_U32, SCENE(geometry.side),
     SONJECT_SIDE_STARBOARD, NULL, NULL},
    {"input.transfer.kind", file, "intensity", TYPE_U32, SCENE(transfer.kind),
     SONJECT_TRANSFER_INTENSITY, NULL, NULL},
    {"input.transfer.parameter", file, "2.2", TYPE_DOUBLE, SCENE(transfer.parameter), 2.2, NULL,
     "input.transfer.kind=gamma"},
    {"input.transfer.offset", file, "-96 dB", TYPE_DOUBLE, SCENE(transfer.offset), -96.0, NULL,
     "input.transfer={kind: decibel, parameter: 0.378}"},
    {"input.transfer.full_scale", file, "4095", TYPE_DOUBLE, SCENE(transfer.full_scale), 4095.0,
     NULL, "input.transfer.kind=amplitude"},
    {"patch.row", small, "3", TYPE_U64, SCENE(patch.first_row), 3.0, NULL,
     "patch={rows: 1, columns: 1}"},
    {"patch.column", small, "1099511627776", TYPE_U64, SCENE(patch.first_column), 1099511627776.0,
     NULL, "patch={rows: 1, columns: 1}"},
    {"patch.rows", small, "11", TYPE_U64, SCENE(patch.rows), 11.0, NULL, "patch={columns: 1}"},
    {"patch.columns", small, "12", TYPE_U64, SCENE(patch.columns), 12.0, NULL, "patch={rows: 1}"},
    {"sonar.frequency", small, "0.3 MHz", TYPE_DOUBLE, SCENE(sonar.centre_frequency_hz), 300e3,
     NULL, NULL},
    {"sonar.bandwidth", small, "20000 Hz", TYPE_DOUBLE, SCENE(sonar.bandwidth_hz), 20e3, NULL,
     NULL},
    {"sonar.altitude", small, "12", TYPE_DOUBLE, SCENE(sonar.altitude_m), 12.0, NULL, NULL},
    {"sonar.resolution", small, "3 cm", TYPE_DOUBLE, SCENE(sonar.along_track_resolution_m), 0.03,
     NULL, NULL},
    {"sonar.transducer", small, "20 cm", TYPE_DOUBLE, SCENE(sonar.transducer_side_m), 0.2, NULL,
     NULL},
    {"sonar.response", small, "hamming", TYPE_U32, SCENE(sonar.response_window),
     SONJECT_WINDOW_HAMMING, NULL, NULL},
    {"sonar.response.taylor.sidelobes", small, "40 dB", TYPE_DOUBLE,
     SCENE(sonar.taylor_sidelobe_db), 40.0, NULL, "sonar.response={taylor: {terms: 5}}"},
    {"sonar.response.taylor.terms", small, "7", TYPE_U32, SCENE(sonar.taylor_terms), 7.0, NULL,
     "sonar.response={taylor: {sidelobes: 35 dB}}"},
    {"sonar.kind", small, "real", TYPE_U32, SCENE(sonar.kind), SONJECT_SONAR_REAL, NULL,
     "sonar.array={length: 1 m}"},
    {"sonar.aperture", small, "18 deg", TYPE_DOUBLE, SCENE(sonar.aperture_rad), PI / 10.0, NULL,
     NULL},
    {"sonar.array.length", small, "40 cm", TYPE_DOUBLE, SCENE(sonar.array_length_m), 0.4, NULL,
     "sonar.kind=real"},
    {"sonar.array.height", sidescan, "5 cm", TYPE_DOUBLE, SCENE(sonar.array_height_m), 0.05, NULL,
     NULL},
    {"sonar.array.heading", sidescan, "-9 deg", TYPE_DOUBLE, SCENE(sonar.array_heading_rad),
     -PI / 20.0, NULL, NULL},
    {"sonar.array.pitch", sidescan, "9 deg", TYPE_DOUBLE, SCENE(sonar.array_pitch_rad), PI / 20.0,
     NULL, NULL},
    {"sonar.array.depression", sidescan, "30 deg", TYPE_DOUBLE, SCENE(sonar.array_depression_rad),
     PI / 6.0, NULL, NULL},
    {"sonar.pulse.kind", small, "chirp", TYPE_U32, SCENE(pulse.kind), SONJECT_PULSE_CHIRP, NULL,
     NULL},
    {"sonar.pulse.window", small, "hann", TYPE_U32, SCENE(pulse.window), SONJECT_PULSE_HANN, NULL,
     "sonar.pulse={kind: chirp}"},
    {"sonar.pulse.window.taylor.sidelobes", small, "40 dB", TYPE_DOUBLE,
     SCENE(pulse.taylor_sidelobe_db), 40.0, NULL,
     "sonar.pulse={kind: chirp, window: {taylor: {terms: 5}}}"},
    {"sonar.pulse.window.taylor.terms", small, "7", TYPE_U32, SCENE(pulse.taylor_terms), 7.0, NULL,
     "sonar.pulse={kind: chirp, window: {taylor: {sidelobes: 35 dB}}}"},
    {"sonar.pulse.file", small, SOURCE_ROOT "/tests/unit/pulse.csv", TYPE_U64,
     SCENE(pulse_table.count), 5.0, NULL, "sonar.pulse={kind: table}"},
    {"sonar.measured_response", small, SOURCE_ROOT "/tests/unit/cross_range.csv", TYPE_U64,
     SCENE(cross_range_table.count), 6.0, NULL, NULL},
    {"sonar.motion.sway[].amplitude", small, "2 mm", TYPE_DOUBLE,
     SCENE(motion.params.sways[0].amplitude_m), 0.002, NULL,
     "sonar.motion={sway: [{wavelength: 3 m}]}"},
    {"sonar.motion.sway[].wavelength", small, "3 m", TYPE_DOUBLE,
     SCENE(motion.params.sways[0].wavelength_m), 3.0, NULL,
     "sonar.motion={sway: [{amplitude: 2 mm}]}"},
    {"sonar.motion.sway[].phase", small, "2 rad", TYPE_DOUBLE,
     SCENE(motion.params.sways[0].phase_rad), 2.0, NULL,
     "sonar.motion={sway: [{amplitude: 2 mm, wavelength: 3 m}]}"},
    {"sonar.motion.random.rms", small, "1 mm", TYPE_DOUBLE, SCENE(motion.params.random_rms_m),
     0.001, NULL, "sonar.motion={random: {correlation: 2 m}}"},
    {"sonar.motion.random.correlation", small, "2 m", TYPE_DOUBLE,
     SCENE(motion.params.random_correlation_m), 2.0, NULL, "sonar.motion={random: {rms: 1 mm}}"},
    {"sonar.motion.random.seed", small, "9", TYPE_U64, SCENE(motion.params.seed), 9.0, NULL,
     "sonar.motion={random: {rms: 1 mm, correlation: 2 m}}"},
    {"sonar.motion.file", small, SOURCE_ROOT "/tests/unit/sway.csv", TYPE_U64,
     SCENE(motion.sway_table.count), 3.0, NULL, NULL},
    {"sonar.motion.yaw.advance", small, "40 cm", TYPE_DOUBLE, SCENE(motion.params.yaw_advance_m),
     0.4, NULL, NULL},
    {"sonar.motion.yaw.bias", small, "-0.009 rad", TYPE_DOUBLE, SCENE(motion.params.yaw_bias_rad),
     -0.009, NULL, YAW},
    {"sonar.motion.yaw.sines[].amplitude", small, "0.02 rad", TYPE_DOUBLE,
     SCENE(motion.params.yaws[0].amplitude_rad), 0.02, NULL,
     "sonar.motion.yaw={advance: 1, sines: [{wavelength: 3 m}]}"},
    {"sonar.motion.yaw.sines[].wavelength", small, "3 m", TYPE_DOUBLE,
     SCENE(motion.params.yaws[0].wavelength_m), 3.0, NULL,
     "sonar.motion.yaw={advance: 1, sines: [{amplitude: 2e-3 rad}]}"},
    {"sonar.motion.yaw.sines[].phase", small, "2 rad", TYPE_DOUBLE,
     SCENE(motion.params.yaws[0].phase_rad), 2.0, NULL,
     "sonar.motion.yaw={advance: 1, sines: [{amplitude: 2e-3 rad, wavelength: 3 m}]}"},
    {"sonar.motion.yaw.random.rms", small, "0.01 rad", TYPE_DOUBLE,
     SCENE(motion.params.yaw_random_rms_rad), 0.01, NULL,
     "sonar.motion.yaw={advance: 1, random: {correlation: 2 m}}"},
    {"sonar.motion.yaw.random.correlation", small, "2 m", TYPE_DOUBLE,
     SCENE(motion.params.yaw_random_correlation_m), 2.0, NULL,
     "sonar.motion.yaw={advance: 1, random: {rms: 0.01 rad}}"},
    {"sonar.motion.yaw.random.seed", small, "9", TYPE_U64, SCENE(motion.params.yaw_seed), 9.0, NULL,
     "sonar.motion.yaw={advance: 1, random: {rms: 0.01 rad, correlation: 2 m}}"},
    {"sonar.motion.yaw.file", small, SOURCE_ROOT "/tests/unit/yaw.csv", TYPE_U64,
     SCENE(motion.yaw_table.count), 2.0, NULL, YAW},
    {"medium.sound_speed", small, "1.48 km/s", TYPE_DOUBLE, SCENE(medium.sound_speed_mps), 1480.0,
     NULL, NULL},
    {"medium.reference_sound_speed", small, "1490 m/s", TYPE_DOUBLE,
     SCENE(medium.reference_sound_speed_mps), 1490.0, NULL, NULL},
    {"medium.absorption", small, "0.03 dB/m", TYPE_DOUBLE, SCENE(medium.absorption_db_per_m), 0.03,
     NULL, NULL},
    /* how these four become an absorption: test_scene_medium.c */
    {"medium.absorption.temperature", small, "12 C", TYPE_NOTHING, 0, 0.0, NULL,
     "medium.absorption={salinity: 35, depth: 20 m}"},
    {"medium.absorption.salinity", small, "35", TYPE_NOTHING, 0, 0.0, NULL,
     "medium.absorption={temperature: 12 C, depth: 20 m}"},
    {"medium.absorption.depth", small, "20 m", TYPE_NOTHING, 0, 0.0, NULL,
     "medium.absorption={temperature: 12 C, salinity: 35}"},
    {"medium.absorption.ph", small, "7.7", TYPE_NOTHING, 0, 0.0, NULL,
     "medium.absorption={temperature: 12 C, salinity: 35, depth: 20 m}"},
    {"medium.layers[].bottom", small, "12 m", TYPE_DOUBLE, LAYER(1, bottom_m), 12.0, NULL,
     "medium.layers=[{bottom: 0, sound_speed: 1490}, {sound_speed: 1500}]"},
    {"medium.layers[].sound_speed", small, "1.51 km/s", TYPE_DOUBLE, LAYER(1, speed_mps), 1510.0,
     NULL, "medium.layers=[{bottom: 0, sound_speed: 1490}, {bottom: 12}]"},
    {"medium.layers[].density", small, "1.02 g/cm3", TYPE_DOUBLE, LAYER(1, density), 1020.0, NULL,
     "medium.layers=[{bottom: 0, sound_speed: 1490, density: 1025}, {bottom: 12, sound_speed: "
     "1500}]"},
    {"medium.profile.file", casting, CAST, TYPE_DOUBLE, LAYER(1, bottom_m), 3.0, NULL, NULL},
    {"medium.profile.heights", casting, "[4 m, 12 m]", TYPE_DOUBLE, LAYER(1, bottom_m), 4.0, NULL,
     "medium.profile={sound_speeds: [1490, 1500]}"},
    {"medium.profile.depths", casting, "[8 m, 15 m]", TYPE_DOUBLE, LAYER(1, bottom_m), 5.0, NULL,
     "medium.profile={sound_speeds: [1500, 1490]}"},
    {"medium.profile.sound_speeds", casting, "[1.48 km/s, 1500]", TYPE_DOUBLE, LAYER(0, speed_mps),
     1480.0, NULL, "medium.profile={heights: [4 m, 12 m]}"},
    {"seabed.lambert", small, "0.25", TYPE_DOUBLE, SCENE(seabed.lambert), 0.25, NULL, NULL},
    {"seabed.map", small, "despeckled", TYPE_U32, SCENE(seabed.map), SONJECT_MAP_DESPECKLED, NULL,
     NULL},
    {"surface.depth", small, "20 m", TYPE_DOUBLE, SCENE(surface.water_depth_m), 20.0, NULL, NULL},
    {"surface.reflection", small, "-0.9", TYPE_DOUBLE, SCENE(surface.material.reflection), -0.9,
     NULL, "surface.depth=20 m"},
    {"surface.roughness", small, "5 cm", TYPE_DOUBLE, SCENE(surface.material.roughness_m), 0.05,
     NULL, "surface.depth=20 m"},
    {"surface.lambert", small, "0.1", TYPE_DOUBLE, SCENE(surface.material.lambert), 0.1, NULL,
     "surface.depth=20 m"},
    {"surface.exponent", small, "2", TYPE_DOUBLE, SCENE(surface.material.lambert_exponent), 2.0,
     NULL, "surface.depth=20 m"},
    {"surface.glossy.albedo", small, "0.5", TYPE_DOUBLE, SCENE(surface.material.glossy_albedo), 0.5,
     NULL, "surface.depth=20 m"},
    {"surface.glossy.slope", small, "0.1", TYPE_DOUBLE, SCENE(surface.material.glossy_slope), 0.1,
     NULL, "surface.depth=20 m"},
    {"seabed.level_radius", small, "4 m", TYPE_DOUBLE, SCENE(seabed.level_radius_m), 4.0, NULL,
     NULL},
    {"seabed.despeckle_radius", small, "5 cm", TYPE_DOUBLE, SCENE(seabed.despeckle_radius_m), 0.05,
     NULL, NULL},
    {"seabed.relief[].heights.file", small, HEIGHTS, TYPE_U32, GRID(columns), 3.0, NULL,
     "seabed.relief=[{heights: {unit: cm, row_spacing: 1, column_spacing: 1, first_ground_range: "
     "30}}]"},
    {"seabed.relief[].heights.array", small, "depths", TYPE_U32, GRID(columns), 3.0, NULL,
     "seabed.relief=[{heights: {file: '" ARRAYS
     "', unit: cm, row_spacing: 1, column_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].heights.unit", small, "10 cm", TYPE_NOTHING, 0, 0.0, NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', row_spacing: 1, column_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].heights.positive", small, "down", TYPE_NOTHING, 0, 0.0, NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', unit: cm, row_spacing: 1, column_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].heights.offset", small, "-20 cm", TYPE_NOTHING, 0, 0.0, NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', unit: cm, row_spacing: 1, column_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].heights.row_spacing", small, "50 cm", TYPE_DOUBLE, GRID(row_spacing_m), 0.5,
     NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', unit: cm, column_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].heights.column_spacing", small, "25 cm", TYPE_DOUBLE, GRID(column_spacing_m),
     0.25, NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', unit: cm, row_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].heights.first_ground_range", small, "38 m", TYPE_DOUBLE,
     GRID(first_ground_range_m), 38.0, NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', unit: cm, row_spacing: 1, column_spacing: 1}}]"},
    {"seabed.relief[].heights.first_along_track", small, "-2 m", TYPE_DOUBLE,
     GRID(first_along_track_m), -2.0, NULL,
     "seabed.relief=[{heights: {file: '" HEIGHTS
     "', unit: cm, row_spacing: 1, column_spacing: 1, first_ground_range: 30}}]"},
    {"seabed.relief[].ripples.wavelength", small, "40 cm", TYPE_DOUBLE, RELIEF(wavelength_m), 0.4,
     NULL, "seabed.relief=[{ripples: {height: 5 cm}}]"},
    {"seabed.relief[].ripples.height", small, "4 cm", TYPE_DOUBLE, RELIEF(height_m), 0.04, NULL,
     "seabed.relief=[{ripples: {wavelength: 1 m}}]"},
    {"seabed.relief[].ripples.heading", small, "90 deg", TYPE_DOUBLE, RELIEF(heading_rad), PI / 2.0,
     NULL, "seabed.relief=[{ripples: {wavelength: 1 m, height: 5 cm}}]"},
    {"seabed.relief[].ripples.phase", small, "90 deg", TYPE_DOUBLE, RELIEF(phase_rad), PI / 2.0,
     NULL, "seabed.relief=[{ripples: {wavelength: 1 m, height: 5 cm}}]"},
    {"seabed.relief[].ripples.sharpness", small, "0.5", TYPE_DOUBLE, RELIEF(sharpness), 0.5, NULL,
     "seabed.relief=[{ripples: {wavelength: 1 m, height: 5 cm}}]"},
    {"seabed.relief[].ripples.irregularity", small, "0.25", TYPE_DOUBLE, RELIEF(irregularity), 0.25,
     NULL, "seabed.relief=[{ripples: {wavelength: 1 m, height: 5 cm}}]"},
    {"seabed.relief[].ripples.seed", small, "9", TYPE_U64, RELIEF(seed), 9.0, NULL,
     "seabed.relief=[{ripples: {wavelength: 1 m, height: 5 cm}}]"},
    {"seabed.relief[].mound.position", small, "centre", TYPE_U32, RELIEF(position_kind),
     SONJECT_POSITION_PATCH_CENTRE, NULL, "seabed.relief=[{mound: {radius: 1 m, height: 10 cm}}]"},
    {"seabed.relief[].mound.position.along_track", small, "2 m", TYPE_DOUBLE,
     RELIEF(position_along), 2.0, NULL,
     "seabed.relief=[{mound: {radius: 1 m, height: 10 cm, position: {slant_range: 41}}}]"},
    {"seabed.relief[].mound.position.slant_range", small, "42 m", TYPE_DOUBLE,
     RELIEF(position_range), 42.0, NULL,
     "seabed.relief=[{mound: {radius: 1 m, height: 10 cm, position: {along_track: 1}}}]"},
    {"seabed.relief[].mound.position.row", small, "2.5", TYPE_DOUBLE, RELIEF(position_along), 2.5,
     NULL, "seabed.relief=[{mound: {radius: 1 m, height: 10 cm, position: {column: 3}}}]"},
    {"seabed.relief[].mound.position.column", small, "3.5", TYPE_DOUBLE, RELIEF(position_range),
     3.5, NULL, "seabed.relief=[{mound: {radius: 1 m, height: 10 cm, position: {row: 3}}}]"},
    {"seabed.relief[].mound.radius", small, "2 m", TYPE_DOUBLE, RELIEF(radius_m), 2.0, NULL,
     "seabed.relief=[{mound: {height: 10 cm}}]"},
    {"seabed.relief[].mound.height", small, "30 cm", TYPE_DOUBLE, RELIEF(height_m), 0.3, NULL,
     "seabed.relief=[{mound: {radius: 1 m}}]"},
    {"seabed.relief[].pit.position", small, "centre", TYPE_U32, RELIEF(position_kind),
     SONJECT_POSITION_PATCH_CENTRE, NULL, "seabed.relief=[{pit: {radius: 1 m, depth: 10 cm}}]"},
    {"seabed.relief[].pit.position.along_track", small, "2 m", TYPE_DOUBLE, RELIEF(position_along),
     2.0, NULL, "seabed.relief=[{pit: {radius: 1 m, depth: 10 cm, position: {slant_range: 41}}}]"},
    {"seabed.relief[].pit.position.slant_range", small, "42 m", TYPE_DOUBLE, RELIEF(position_range),
     42.0, NULL, "seabed.relief=[{pit: {radius: 1 m, depth: 10 cm, position: {along_track: 1}}}]"},
    {"seabed.relief[].pit.position.row", small, "2.5", TYPE_DOUBLE, RELIEF(position_along), 2.5,
     NULL, "seabed.relief=[{pit: {radius: 1 m, depth: 10 cm, position: {column: 3}}}]"},
    {"seabed.relief[].pit.position.column", small, "3.5", TYPE_DOUBLE, RELIEF(position_range), 3.5,
     NULL, "seabed.relief=[{pit: {radius: 1 m, depth: 10 cm, position: {row: 3}}}]"},
    {"seabed.relief[].pit.radius", small, "2 m", TYPE_DOUBLE, RELIEF(radius_m), 2.0, NULL,
     "seabed.relief=[{pit: {depth: 10 cm}}]"},
    {"seabed.relief[].pit.depth", small, "30 cm", TYPE_DOUBLE, RELIEF(height_m), 0.3, NULL,
     "seabed.relief=[{pit: {radius: 1 m}}]"},
    {"seabed.relief[].scour.object", small, "can", TYPE_TEXT, RELIEF(object), 0.0, "can",
     "seabed.relief=[{scour: {width: 1 m, depth: 5 cm}}]"},
    {"seabed.relief[].scour.width", small, "60 cm", TYPE_DOUBLE, RELIEF(width_m), 0.6, NULL,
     "seabed.relief=[{scour: {object: can, depth: 5 cm}}]"},
    {"seabed.relief[].scour.depth", small, "6 cm", TYPE_DOUBLE, RELIEF(height_m), 0.06, NULL,
     "seabed.relief=[{scour: {object: can, width: 1 m}}]"},
    {"seabed.forward", small, "medium sand", TYPE_U32, SCENE(seabed.forward.reflection_kind),
     SONJECT_REFLECTION_FLUID, NULL, NULL},
    {"seabed.forward.sediment", small, "silt", TYPE_U32, SCENE(seabed.forward.reflection_kind),
     SONJECT_REFLECTION_FLUID, NULL, NULL},
    {"seabed.forward.rule", small, "map", TYPE_U32, SCENE(seabed.forward_rule), SONJECT_FORWARD_MAP,
     NULL, NULL},
    {"seabed.forward.reflection", small, "0.25", TYPE_DOUBLE, SCENE(seabed.forward.reflection),
     0.25, NULL, NULL},
    {"seabed.forward.roughness", small, "5 mm", TYPE_DOUBLE, SCENE(seabed.forward.roughness_m),
     0.005, NULL, NULL},
    {"seabed.forward.lambert", small, "0.125", TYPE_DOUBLE, SCENE(seabed.forward.lambert), 0.125,
     NULL, NULL},
    {"seabed.forward.exponent", small, "2", TYPE_DOUBLE, SCENE(seabed.forward.lambert_exponent),
     2.0, NULL, NULL},
    {"seabed.forward.glossy.albedo", small, "0.5", TYPE_DOUBLE, SCENE(seabed.forward.glossy_albedo),
     0.5, NULL, NULL},
    {"seabed.forward.glossy.slope", small, "0.25", TYPE_DOUBLE, SCENE(seabed.forward.glossy_slope),
     0.25, NULL, "seabed.forward.glossy.albedo=0.5"},
    {"seabed.forward.fluid.density", small, "1.5", TYPE_DOUBLE, SCENE(seabed.forward.density_ratio),
     1.5, NULL, "seabed.forward.fluid.speed=1.25"},
    {"seabed.forward.fluid.speed", small, "1.25", TYPE_DOUBLE, SCENE(seabed.forward.speed_ratio),
     1.25, NULL, "seabed.forward.fluid.density=1.5"},
    {"seabed.forward.fluid.loss", small, "0.125", TYPE_DOUBLE, SCENE(seabed.forward.loss), 0.125,
     NULL, "seabed.forward.sediment=clay"},
    {"injection.mode", small, "resynthesise", TYPE_U32, SCENE(injection.mode),
     SONJECT_MODE_RESYNTHESISE, NULL, NULL},
    {"injection.columns", small, "paper", TYPE_U32, SCENE(injection.column_rule),
     SONJECT_COLUMNS_PAPER, NULL, NULL},
    {"injection.noise_floor", small, "-30 dB", TYPE_DOUBLE, SCENE(injection.noise_floor_db), -30.0,
     NULL, NULL},
    {"injection.influence", small, "-35 dB", TYPE_DOUBLE, SCENE(injection.influence_db), -35.0,
     NULL, NULL},
    {"injection.rays", small, "0.5", TYPE_DOUBLE, SCENE(injection.ray_scale), 0.5, NULL, NULL},
    {"injection.seed", small, "2199023255552", TYPE_U64, SCENE(injection.seed), 2199023255552.0,
     NULL, NULL},
    {"injection.interactions", small, "3", TYPE_U32, SCENE(injection.interactions), 3.0, NULL,
     NULL},
    {"injection.estimator", small, "brute_force", TYPE_U32, SCENE(injection.estimator),
     SONJECT_ESTIMATOR_BRUTE_FORCE, NULL, "injection.mode=resynthesise"},
    {"elements.pings.count", small, "250", TYPE_U32, SCENE(elements.pings), 250.0, NULL, NULL},
    {"elements.pings.first", small, "-3.5 m", TYPE_DOUBLE, SCENE(elements.first_ping_m), -3.5, NULL,
     NULL},
    {"elements.pings.spacing", small, "10 cm", TYPE_DOUBLE, SCENE(elements.ping_spacing_m), 0.1,
     NULL, NULL},
    {"elements.transmitter.offset", small, "-0.2 m", TYPE_DOUBLE,
     SCENE(elements.transmitter_offset_m), -0.2, NULL, NULL},
    {"elements.transmitter.length", small, "5 cm", TYPE_DOUBLE,
     SCENE(elements.transmitter_length_m), 0.05, NULL, NULL},
    {"elements.hydrophones.count", small, "16", TYPE_U32, SCENE(elements.hydrophones), 16.0, NULL,
     NULL},
    {"elements.hydrophones.first", small, "0.3 m", TYPE_DOUBLE, SCENE(elements.first_hydrophone_m),
     0.3, NULL, NULL},
    {"elements.hydrophones.spacing", small, "4 cm", TYPE_DOUBLE,
     SCENE(elements.hydrophone_spacing_m), 0.04, NULL, NULL},
    {"elements.hydrophones.length", small, "0", TYPE_DOUBLE, SCENE(elements.hydrophone_length_m),
     0.0, NULL, NULL},
    {"elements.form", small, "passband", TYPE_U32, SCENE(elements.form), SONJECT_SERIES_PASSBAND,
     NULL, NULL},
    {"elements.pulse", small, "chirp", TYPE_U32, SCENE(elements.pulse), SONJECT_SERIES_CHIRP, NULL,
     NULL},
    {"elements.chirp", small, "20 ms", TYPE_DOUBLE, SCENE(elements.chirp_duration_s), 0.02, NULL,
     NULL},
    {"elements.sampling_rate", small, "70 kHz", TYPE_DOUBLE, SCENE(elements.sampling_rate_hz), 70e3,
     NULL, NULL},
    {"elements.source_level", small, "220 dB", TYPE_DOUBLE, SCENE(elements.source_level_db), 220.0,
     NULL, NULL},
    {"elements.first_time", small, "50 ms", TYPE_DOUBLE, SCENE(elements.first_time_s), 0.05, NULL,
     NULL},
    {"elements.last_time", small, "70 ms", TYPE_DOUBLE, SCENE(elements.last_time_s), 0.07, NULL,
     NULL},
    {"elements.aspect_limit", small, "0.25 rad", TYPE_DOUBLE, SCENE(elements.aspect_limit_rad),
     0.25, NULL, NULL},
    {"injection.match.response", small, "nominal", TYPE_U32, SCENE(injection.match_response), 0.0,
     NULL, NULL},
    {"injection.match.looks", small, "2.5", TYPE_DOUBLE, SCENE(injection.match_looks), 2.5, NULL,
     NULL},
    {"injection.match.saturation", small, "full_scale", TYPE_U32, SCENE(injection.match_saturation),
     0.0, NULL, NULL},
    {"injection.order_energies", small, "true", TYPE_U32, SCENE(injection.order_energies), 1.0,
     NULL, NULL},
    {"objects[].name", small, "M\xC3\xBCll 7: #1", TYPE_TEXT, OBJECT(name), 0.0,
     "M\xC3\xBCll 7: #1", NULL},
    {"objects[].class", small, "\"mine\"", TYPE_TEXT, OBJECT(class_name), 0.0, "mine", NULL},
    {"objects[].shape", small, "capsule", TYPE_U32, OBJECT(shape), SONJECT_SHAPE_CAPSULE, NULL,
     "objects[0].length=2 m"},
    {"objects[].length", small, "1.2 m", TYPE_DOUBLE, OBJECT(length_m), 1.2, NULL,
     "objects[0].shape=cylinder"},
    {"objects[].width", small, "0.8 m", TYPE_DOUBLE, OBJECT(width_m), 0.8, NULL,
     "objects[0]={shape: plane, length: 1 m}"},
    {"objects[].diameter", small, "30 cm", TYPE_DOUBLE, OBJECT(diameter_m), 0.3, NULL, NULL},
    {"objects[].height", small, "25 cm", TYPE_DOUBLE, OBJECT(height_m), 0.25, NULL,
     "objects[0].shape=cone"},
    {"objects[].top_diameter", small, "20 cm", TYPE_DOUBLE, OBJECT(top_diameter_m), 0.2, NULL,
     "objects[0]={shape: truncated_cone, diameter: 1, height: 0.5}"},
    {"objects[].front_height", small, "10 cm", TYPE_DOUBLE, OBJECT(front_height_m), 0.1, NULL,
     "objects[0]={shape: wedge, length: 1, width: 1, height: 0.5}"},
    {"objects[].nose_end", small, "open", TYPE_U32, OBJECT(nose_end), SONJECT_END_OPEN, NULL,
     "objects[0]={shape: cylinder, length: 1, diameter: 0.5}"},
    {"objects[].nose_end.depth", small, "10 cm", TYPE_DOUBLE, OBJECT(nose_end_depth_m), 0.1, NULL,
     "objects[0]={shape: cylinder, length: 1, diameter: 0.5}"},
    {"objects[].tail_end", small, "spherical", TYPE_U32, OBJECT(tail_end), SONJECT_END_SPHERICAL,
     NULL, "objects[0]={shape: cylinder, length: 1, diameter: 0.5}"},
    {"objects[].tail_end.depth", small, "10 cm", TYPE_DOUBLE, OBJECT(tail_end_depth_m), 0.1, NULL,
     "objects[0]={shape: cylinder, length: 1, diameter: 0.5}"},
    {"objects[].cuts[].azimuth", small, "90 deg", TYPE_DOUBLE, OBJECT(cuts[0].azimuth_rad),
     PI / 2.0, NULL, "objects[0].cuts=[{distance: 0}]"},
    {"objects[].cuts[].elevation", small, "-90 deg", TYPE_DOUBLE, OBJECT(cuts[0].elevation_rad),
     -PI / 2.0, NULL, "objects[0].cuts=[{distance: 0}]"},
    {"objects[].cuts[].distance", small, "-5 cm", TYPE_DOUBLE, OBJECT(cuts[0].distance_m), -0.05,
     NULL, "objects[0].cuts=[{distance: 0}]"},
    {"objects[].burial.fraction", small, "0.25", TYPE_DOUBLE, OBJECT(burial_fraction), 0.25, NULL,
     NULL},
    {"objects[].level", small, "physical", TYPE_U32, OBJECT(level_kind), 0.0, NULL, NULL},
    {"objects[].level.target_strength", small, "-20 dB", TYPE_DOUBLE, OBJECT(level_db), -20.0, NULL,
     NULL},
    {"objects[].level.over_seabed", small, "12 dB", TYPE_DOUBLE, OBJECT(level_db), 12.0, NULL,
     NULL},
    {"objects[].burial.proud", small, "20 cm", TYPE_DOUBLE, OBJECT(proud_height_m), 0.2, NULL,
     NULL},
    {"objects[].position", small, "centre", TYPE_U32, OBJECT(position_kind),
     SONJECT_POSITION_PATCH_CENTRE, NULL, NULL},
    {"objects[].position.along_track", small, "-2 m", TYPE_DOUBLE, OBJECT(position_along), -2.0,
     NULL, "objects[0].position={slant_range: 41}"},
    {"objects[].position.slant_range", small, "42 m", TYPE_DOUBLE, OBJECT(position_range), 42.0,
     NULL, "objects[0].position={along_track: 0}"},
    {"objects[].position.row", small, "1.5", TYPE_DOUBLE, OBJECT(position_along), 1.5, NULL,
     "objects[0].position={column: 2}"},
    {"objects[].position.column", small, "2.25", TYPE_DOUBLE, OBJECT(position_range), 2.25, NULL,
     "objects[0].position={row: 2}"},
    {"objects[].heading", small, "-45 deg", TYPE_DOUBLE, OBJECT(heading_rad), -PI / 4.0, NULL,
     NULL},
    {"objects[].pitch", small, "0.5 rad", TYPE_DOUBLE, OBJECT(pitch_rad), 0.5, NULL, NULL},
    {"objects[].roll", small, "180", TYPE_DOUBLE, OBJECT(roll_rad), PI, NULL, NULL},
    {"objects[].burial", small, "-6.7 cm", TYPE_DOUBLE, OBJECT(burial_m), -0.067, NULL, NULL},
    {"objects[].material.reflection", small, "-0.75", TYPE_DOUBLE, OBJECT(material.reflection),
     -0.75, NULL, NULL},
    {"objects[].material.roughness", small, "2 mm", TYPE_DOUBLE, OBJECT(material.roughness_m),
     0.002, NULL, NULL},
    {"objects[].material.lambert", small, "0.125", TYPE_DOUBLE, OBJECT(material.lambert), 0.125,
     NULL, NULL},
    {"objects[].material", small, "gravel", TYPE_U32, OBJECT(material.reflection_kind),
     SONJECT_REFLECTION_FLUID, NULL, NULL},
    {"objects[].material.name", small, "fine-sand", TYPE_U32, OBJECT(material.reflection_kind),
     SONJECT_REFLECTION_FLUID, NULL, NULL},
    {"objects[].material.exponent", small, "4", TYPE_DOUBLE, OBJECT(material.lambert_exponent), 4.0,
     NULL, NULL},
    {"objects[].material.glossy.albedo", small, "0.25", TYPE_DOUBLE, OBJECT(material.glossy_albedo),
     0.25, NULL, NULL},
    {"objects[].material.glossy.slope", small, "0.5", TYPE_DOUBLE, OBJECT(material.glossy_slope),
     0.5, NULL, "objects[0].material={glossy: {albedo: 0.25}}"},
    {"objects[].material.fluid.density", small, "8", TYPE_DOUBLE, OBJECT(material.density_ratio),
     8.0, NULL, "objects[0].material={fluid: {speed: 4}}"},
    {"objects[].material.fluid.speed", small, "4", TYPE_DOUBLE, OBJECT(material.speed_ratio), 4.0,
     NULL, "objects[0].material={fluid: {density: 8}}"},
    {"objects[].material.fluid.loss", small, "0.0625", TYPE_DOUBLE, OBJECT(material.loss), 0.0625,
     NULL, "objects[0].material={fluid: {density: 8, speed: 4}}"},
#define PART(member)  offsetof(struct scene_part, member)
#define SIZED(member) PART(shape.member)
#define A_PART(keys)  "objects[0]={parts: [{" keys "}]}"
#define A_SPHERE      "shape: sphere, diameter: 1"
#define A_CYLINDER    "shape: cylinder, length: 1, diameter: 0.5"
    {"objects[].target", small, SOURCE_ROOT "/tools/targets/oil_drum.yaml", TYPE_U32, OBJECT(shape),
     SONJECT_SHAPE_PARTS, NULL, "objects[0]={}"},
    {"objects[].parts[].name", small, "left ear", TYPE_TEXT, SIZED(name), 0.0, "left ear",
     A_PART(A_SPHERE)},
    {"objects[].parts[].shape", small, "disc", TYPE_U32, SIZED(shape), SONJECT_SHAPE_DISC, NULL,
     A_PART("diameter: 1")},
    {"objects[].parts[].length", small, "1.2 m", TYPE_DOUBLE, SIZED(length_m), 1.2, NULL,
     A_PART("shape: capsule, diameter: 0.5")},
    {"objects[].parts[].width", small, "0.8 m", TYPE_DOUBLE, SIZED(width_m), 0.8, NULL,
     A_PART("shape: plane, length: 1")},
    {"objects[].parts[].diameter", small, "30 cm", TYPE_DOUBLE, SIZED(diameter_m), 0.3, NULL,
     A_PART("shape: sphere")},
    {"objects[].parts[].height", small, "25 cm", TYPE_DOUBLE, SIZED(height_m), 0.25, NULL,
     A_PART("shape: cone, diameter: 1")},
    {"objects[].parts[].top_diameter", small, "20 cm", TYPE_DOUBLE, SIZED(top_diameter_m), 0.2,
     NULL, A_PART("shape: truncated_cone, diameter: 1, height: 0.5")},
    {"objects[].parts[].front_height", small, "10 cm", TYPE_DOUBLE, SIZED(front_height_m), 0.1,
     NULL, A_PART("shape: wedge, length: 1, width: 1, height: 0.5")},
    {"objects[].parts[].nose_end", small, "open", TYPE_U32, SIZED(nose_end), SONJECT_END_OPEN, NULL,
     A_PART(A_CYLINDER)},
    {"objects[].parts[].nose_end.depth", small, "10 cm", TYPE_DOUBLE, SIZED(nose_end_depth_m), 0.1,
     NULL, A_PART(A_CYLINDER)},
    {"objects[].parts[].tail_end", small, "spherical", TYPE_U32, SIZED(tail_end),
     SONJECT_END_SPHERICAL, NULL, A_PART(A_CYLINDER)},
    {"objects[].parts[].tail_end.depth", small, "10 cm", TYPE_DOUBLE, SIZED(tail_end_depth_m), 0.1,
     NULL, A_PART(A_CYLINDER)},
    {"objects[].parts[].cuts[].azimuth", small, "90 deg", TYPE_DOUBLE, SIZED(cuts[0].azimuth_rad),
     PI / 2.0, NULL, A_PART(A_SPHERE ", cuts: [{distance: 0}]")},
    {"objects[].parts[].cuts[].elevation", small, "-90 deg", TYPE_DOUBLE,
     SIZED(cuts[0].elevation_rad), -PI / 2.0, NULL, A_PART(A_SPHERE ", cuts: [{distance: 0}]")},
    {"objects[].parts[].cuts[].distance", small, "-5 cm", TYPE_DOUBLE, SIZED(cuts[0].distance_m),
     -0.05, NULL, A_PART(A_SPHERE ", cuts: [{distance: 0}]")},
#define MESH(member) offsetof(struct mesh, member)
#define SOLID        SOURCE_ROOT "/tests/unit/tetrahedron.obj"
#define A_MESH       "objects[0]={shape: mesh, mesh: {file: '" SOLID "'}}"
#define A_MESH_PART  A_PART("shape: mesh, mesh: {file: '" SOLID "'}")
    {"objects[].mesh", small, SOLID, TYPE_PATH, MESH(name), 0.0, SOLID, "objects[0]={shape: mesh}"},
    {"objects[].mesh.file", small, SOLID, TYPE_PATH, MESH(name), 0.0, SOLID,
     "objects[0]={shape: mesh}"},
    {"objects[].mesh.unit", small, "cm", TYPE_DOUBLE, MESH(options.unit_m), 0.01, NULL, A_MESH},
    {"objects[].mesh.nose", small, "y", TYPE_U32, MESH(options.axes[0]), 2.0, NULL, A_MESH},
    {"objects[].mesh.up", small, "y", TYPE_U32, MESH(options.axes[2]), 2.0, NULL, A_MESH},
    {"objects[].mesh.open", small, "true", TYPE_NOTHING, 0, 0.0, NULL, A_MESH},
    {"objects[].mesh.smooth", small, "90 deg", TYPE_DOUBLE, MESH(options.smooth_angle_rad),
     PI / 2.0, NULL, A_MESH},
    {"objects[].parts[].mesh", small, SOLID, TYPE_PATH, MESH(name), 0.0, SOLID,
     A_PART("shape: mesh")},
    {"objects[].parts[].mesh.file", small, SOLID, TYPE_PATH, MESH(name), 0.0, SOLID,
     A_PART("shape: mesh")},
    {"objects[].parts[].mesh.unit", small, "cm", TYPE_DOUBLE, MESH(options.unit_m), 0.01, NULL,
     A_MESH_PART},
    {"objects[].parts[].mesh.nose", small, "y", TYPE_U32, MESH(options.axes[0]), 2.0, NULL,
     A_MESH_PART},
    {"objects[].parts[].mesh.up", small, "y", TYPE_U32, MESH(options.axes[2]), 2.0, NULL,
     A_MESH_PART},
    {"objects[].parts[].mesh.open", small, "true", TYPE_NOTHING, 0, 0.0, NULL, A_MESH_PART},
    {"objects[].parts[].mesh.smooth", small, "90 deg", TYPE_DOUBLE, MESH(options.smooth_angle_rad),
     PI / 2.0, NULL, A_MESH_PART},
    {"objects[].parts[].at.along", small, "20 cm", TYPE_DOUBLE, PART(centre[0]), 0.2, NULL,
     A_PART(A_SPHERE)},
    {"objects[].parts[].at.across", small, "-3 m", TYPE_DOUBLE, PART(centre[1]), -3.0, NULL,
     A_PART(A_SPHERE)},
    {"objects[].parts[].at.up", small, "1.5 m", TYPE_DOUBLE, PART(centre[2]), 1.5, NULL,
     A_PART(A_SPHERE)},
    /* right angles: the sine is 1 */
    {"objects[].parts[].heading", small, "90 deg", TYPE_DOUBLE, PART(axes[0][1]), 1.0, NULL,
     A_PART(A_SPHERE)},
    {"objects[].parts[].pitch", small, "90 deg", TYPE_DOUBLE, PART(axes[0][2]), 1.0, NULL,
     A_PART(A_SPHERE)},
    {"objects[].parts[].roll", small, "90 deg", TYPE_DOUBLE, PART(axes[1][2]), 1.0, NULL,
     A_PART(A_SPHERE)},
    {"objects[].parts[].parts", small, "[{shape: sphere, diameter: 0.75}]", TYPE_DOUBLE,
     SIZED(diameter_m), 0.75, NULL, A_PART("name: group")},
    {"objects[].parts[].material.reflection", small, "-0.75", TYPE_DOUBLE,
     SIZED(material.reflection), -0.75, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material.roughness", small, "2 mm", TYPE_DOUBLE,
     SIZED(material.roughness_m), 0.002, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material", small, "gravel", TYPE_U32, SIZED(material.reflection_kind),
     SONJECT_REFLECTION_FLUID, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material.name", small, "fine-sand", TYPE_U32,
     SIZED(material.reflection_kind), SONJECT_REFLECTION_FLUID, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material.glossy.albedo", small, "0.25", TYPE_DOUBLE,
     SIZED(material.glossy_albedo), 0.25, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material.glossy.slope", small, "0.5", TYPE_DOUBLE,
     SIZED(material.glossy_slope), 0.5, NULL,
     A_PART(A_SPHERE ", material: {glossy: {albedo: 0.25}}")},
    {"objects[].parts[].material.lambert", small, "0.125", TYPE_DOUBLE, SIZED(material.lambert),
     0.125, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material.exponent", small, "4", TYPE_DOUBLE,
     SIZED(material.lambert_exponent), 4.0, NULL, A_PART(A_SPHERE)},
    {"objects[].parts[].material.fluid.speed", small, "4", TYPE_DOUBLE, SIZED(material.speed_ratio),
     4.0, NULL, A_PART(A_SPHERE ", material: {fluid: {density: 8}}")},
    {"objects[].parts[].material.fluid.loss", small, "0.0625", TYPE_DOUBLE, SIZED(material.loss),
     0.0625, NULL, A_PART(A_SPHERE ", material: {fluid: {density: 8, speed: 4}}")},
    {"objects[].parts[].material.fluid.density", small, "8", TYPE_DOUBLE,
     SIZED(material.density_ratio), 8.0, NULL, A_PART(A_SPHERE ", material: {fluid: {speed: 4}}")},
#define BOULDER SOURCE_ROOT "/tools/targets/boulder_relief.cl"
#define A_USER  "shape: user, user: {bounding_radius: 1"
    {"objects[].user.bounding_radius", small, "90 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, bounding_radius_m), 0.9, NULL,
     "objects[0]={" A_USER ", file: " BOULDER "}}"},
    {"objects[].user.half_length", small, "30 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, half_length_m), 0.3, NULL,
     "objects[0]={" A_USER ", file: " BOULDER "}}"},
    {"objects[].user.half_width", small, "20 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, half_width_m), 0.2, NULL,
     "objects[0]={" A_USER ", file: " BOULDER "}}"},
    {"objects[].user.half_height", small, "10 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, half_height_m), 0.1, NULL,
     "objects[0]={" A_USER ", file: " BOULDER "}}"},
    {"objects[].user.open", small, "true", TYPE_BOOL, offsetof(struct user_shape, is_open), 1.0,
     NULL, "objects[0]={" A_USER ", file: " BOULDER "}}"},
    /* how code and numbers arrive: test_user_shapes.c */
    {"objects[].user.parameters", small, "[1, 2]", TYPE_NOTHING, 0, 0.0, NULL,
     "objects[0]={" A_USER ", file: " BOULDER "}}"},
    {"objects[].user.file", small, BOULDER, TYPE_NOTHING, 0, 0.0, NULL, "objects[0]={" A_USER "}}"},
    {"objects[].user.code", small, "float shape_distance(); float3 shape_normal();", TYPE_NOTHING,
     0, 0.0, NULL, "objects[0]={" A_USER "}}"},
    {"objects[].parts[].user.bounding_radius", small, "90 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, bounding_radius_m), 0.9, NULL,
     A_PART(A_USER ", file: " BOULDER "}")},
    {"objects[].parts[].user.half_length", small, "30 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, half_length_m), 0.3, NULL, A_PART(A_USER ", file: " BOULDER "}")},
    {"objects[].parts[].user.half_width", small, "20 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, half_width_m), 0.2, NULL, A_PART(A_USER ", file: " BOULDER "}")},
    {"objects[].parts[].user.half_height", small, "10 cm", TYPE_DOUBLE,
     offsetof(struct user_shape, half_height_m), 0.1, NULL, A_PART(A_USER ", file: " BOULDER "}")},
    {"objects[].parts[].user.open", small, "true", TYPE_BOOL, offsetof(struct user_shape, is_open),
     1.0, NULL, A_PART(A_USER ", file: " BOULDER "}")},
    /* how code and numbers arrive: test_user_shapes.c */
    {"objects[].parts[].user.parameters", small, "[1, 2]", TYPE_NOTHING, 0, 0.0, NULL,
     A_PART(A_USER ", file: " BOULDER "}")},
    {"objects[].parts[].user.file", small, BOULDER, TYPE_NOTHING, 0, 0.0, NULL, A_PART(A_USER "}")},
    {"objects[].parts[].user.code", small, "float shape_distance(); float3 shape_normal();",
     TYPE_NOTHING, 0, 0.0, NULL, A_PART(A_USER "}")},
};

/* All keys, for json_decref. */
static inline json_t *list_keys(void)
{
    struct report report = {{0}, NULL, NULL};
    char *text;
    assert_int_equal(scene_keys_json(&report, &text), SONJECT_OK);
    json_t *keys = json_loads(text, 0, NULL);
    assert_true(json_is_array(keys));
    free(text);
    return keys;
}

/* What is said of a key; "" for null. */
static inline const char *text_of(const json_t *key, const char *what)
{
    const char *text = json_string_value(json_object_get(key, what));
    return text ? text : "";
}

static inline double number_at(const void *structure, const struct key_case *key)
{
    const char *place = (const char *)structure + key->offset;
    double number;
    uint32_t count32;
    uint64_t count64;
    bool flag;
    switch (key->type) {
    case TYPE_DOUBLE:
        memcpy(&number, place, sizeof number);
        return number;
    case TYPE_U32:
        memcpy(&count32, place, sizeof count32);
        return count32;
    case TYPE_U64:
        memcpy(&count64, place, sizeof count64);
        return (double)count64;
    default:
        memcpy(&flag, place, sizeof flag);
        return flag;
    }
}

static inline const void *structure_of(const struct scene *scene, const char *path)
{
    if (strstr(path, ".user."))
        return scene->user_shapes.shapes;
    if (strstr(path, "].mesh"))
        return scene->meshes;
    if (strncmp(path, "objects[].parts", 15) == 0)
        return scene->parts;
    if (strncmp(path, "objects", 7) == 0)
        return scene->objects;
    if (strncmp(path, "medium.layers", 13) == 0 || strncmp(path, "medium.profile", 14) == 0)
        return scene->water_layers;
    if (strncmp(path, "seabed.relief[].heights", 23) == 0)
        return &scene->relief.grid;
    if (strncmp(path, "seabed.relief", 13) == 0)
        return scene->relief.features;
    return scene;
}

/* An entry of each list that a path goes through: the second layer, the first of all others. */
static inline void write_override(char *override, size_t capacity, const struct key_case *key,
                                  const char *value)
{
    size_t length = 0;
    for (const char *c = key->path; *c && length + 2 < capacity; c++) {
        if (*c == ']')
            override[length++] = strncmp(key->path, "medium.layers", 13) == 0 ? '1' : '0';
        override[length++] = *c;
    }
    snprintf(override + length, capacity - length, "=%s", value);
}

static inline const struct key_case *case_of(const char *path)
{
    for (size_t i = 0; i < COUNT(cases); i++)
        if (strcmp(cases[i].path, path) == 0)
            return &cases[i];
    fail_msg("%s has no case", path);
    return NULL;
}

/* Reads the case's scene with a value of its key; NULL: without the key. */
static inline sonject_status read_case(struct scene_folder *folder, const struct key_case *key,
                                       const char *value)
{
    char override[1400];
    const char *overrides[2];
    size_t count = 0;
    if (key->other)
        overrides[count++] = key->other;
    if (value) {
        write_override(override, sizeof override, key, value);
        overrides[count++] = override;
    }
    write_scene(folder, key->base, strlen(key->base));
    scene_clear(&folder->scene);
    memset(&folder->report, 0, sizeof folder->report);
    return scene_file_read_with(&folder->report, folder->file, overrides, count, true,
                                &folder->scene);
}

#endif
