/* Cases for every key of scene files: a value, the place where it must arrive, and what else the
 * key's section then needs. */
#ifndef SCENE_KEYS_H
#define SCENE_KEYS_H

#include <jansson.h>

#include "claims.h"
#include "scene/point_response.h"
#include "scene_folder.h"
#include "schema/keys.h"

#define GEOMETRY "geometry: {row_spacing: 1, column_spacing: 1, first_slant_range: 40}\n"
#define ARRAY    "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10"
#define UNIFORM  "sonject: 1\ninput:\n  uniform: {rows: 4, columns: 5}\n  "
#define PROFILE  "medium.profile={heights: [3 m, 11 m], sound_speeds: [1490, 1500]}"

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
static const char file[] = "sonject: 1\ninput:\n  path: swath.tif\n  " GEOMETRY ARRAY "}\n";

/* The scene of a key (the small one where text is NULL), and what else the key's section then
 * needs. A key takes the first row whose path its own path begins with. */
#define RELIEF(feature) "seabed.relief=[{" feature "}]"
#define HEIGHTS         SOURCE_ROOT "/tests/unit/heights.npy"
#define ARRAYS          SOURCE_ROOT "/tests/unit/heights.mat" /* two arrays of 2 x 3 bytes */
#define H_GRID          "row_spacing: 1, column_spacing: 1, first_ground_range: 30"
#define A_MOUND         "radius: 1 m, height: 10 cm"
#define A_PART(keys)    "objects[0]={parts: [{" keys "}]}"
#define SOLID           SOURCE_ROOT "/tests/unit/tetrahedron.obj"
#define A_CYLINDER      "objects[0]={shape: cylinder, length: 1, diameter: 0.5}"
static const struct base {
    const char *path, *text, *other;
} bases[] = {
    {"band ", UNIFORM GEOMETRY ARRAY "}\nbands: {low: {}, high: {sonar: {frequency: 400e3}}}\n",
     NULL},
    {"input.synthetic.",
     "sonject: 1\ninput:\n  synthetic: {rows: 4, columns: 5}\n  " GEOMETRY ARRAY "}\n", NULL},
    {"input.geometry.row_spacing.",
     UNIFORM "geometry: {row_spacing: {speed: 1, ping_rate: 20}, column_spacing: 1, "
             "first_slant_range: 40}\n" ARRAY "}\n",
     NULL},
    {"input.geometry.", NULL, NULL},
    {"input.uniform.", NULL, NULL},
    {"input.", file, NULL},
    {"patch.", NULL, "patch={rows: 1, columns: 1}"},
    {"sonar.response.taylor.", NULL, "sonar.response={taylor: {sidelobes: 35 dB, terms: 5}}"},
    {"sonar.array.", UNIFORM GEOMETRY ARRAY ", kind: real, array: {length: 1 m}}\n", NULL},
    {"sonar.pulse.window ", NULL, "sonar.pulse={kind: chirp}"},
    {"sonar.pulse.window.", NULL,
     "sonar.pulse={kind: chirp, window: {taylor: {sidelobes: 35 dB, terms: 5}}}"},
    {"sonar.motion.sway[].", NULL, "sonar.motion={sway: [{amplitude: 2 mm, wavelength: 4 m}]}"},
    {"sonar.motion.random.", NULL, "sonar.motion={random: {rms: 2 mm, correlation: 3 m}}"},
    {"sonar.motion.yaw.sines[].", NULL,
     "sonar.motion.yaw={advance: 1, sines: [{amplitude: 2e-3 rad, wavelength: 4 m}]}"},
    {"sonar.motion.yaw.random.", NULL,
     "sonar.motion.yaw={advance: 1, random: {rms: 0.02 rad, correlation: 3 m}}"},
    {"sonar.motion.yaw.", NULL, "sonar.motion.yaw={advance: 1}"},
    {"medium.absorption.", NULL, "medium.absorption={temperature: 9 C, salinity: 30, depth: 30 m}"},
    {"medium.layers[].", NULL,
     "medium.layers=[{bottom: 0, sound_speed: 1490, density: 1025}, {bottom: 10, sound_speed: "
     "1500, density: 1025}]"},
    {"medium.profile.heights ", NULL, PROFILE},
    {"medium.profile.sound_speeds ", NULL, PROFILE},
    {"medium.profile.", UNIFORM GEOMETRY ARRAY "}\nsurface: {depth: 20 m}\n", NULL},
    {"surface.", NULL, "surface.depth=30 m"},
    {"seabed.relief[].heights.", NULL,
     RELIEF("heights: {file: '" HEIGHTS "', unit: cm, " H_GRID "}")},
    {"seabed.relief[].ripples.", NULL, RELIEF("ripples: {wavelength: 1 m, height: 5 cm}")},
    {"seabed.relief[].mound.", NULL, RELIEF("mound: {" A_MOUND "}")},
    {"seabed.relief[].pit.", NULL, RELIEF("pit: {radius: 1 m, depth: 10 cm}")},
    {"seabed.relief[].scour.", NULL, RELIEF("scour: {object: pot, width: 1 m, depth: 5 cm}")},
    {"seabed.forward.glossy.", NULL, "seabed.forward.glossy.albedo=0.4"},
    {"seabed.forward.fluid.", NULL, "seabed.forward.fluid={density: 2, speed: 1.5}"},
    {"objects[].nose_end", NULL, A_CYLINDER},
    {"objects[].tail_end", NULL, A_CYLINDER},
    {"objects[].material.glossy.", NULL, "objects[0].material={glossy: {albedo: 0.2}}"},
    {"objects[].material.fluid.", NULL, "objects[0].material={fluid: {density: 6, speed: 3}}"},
    {"objects[].parts[].", NULL, A_PART("shape: sphere, diameter: 1")},
    {"objects[].mesh.", NULL, "objects[0]={shape: mesh, mesh: {file: '" SOLID "'}}"},
};

enum type {
    TYPE_DOUBLE,
    TYPE_U32,
    TYPE_U64,
    TYPE_BOOL,
    TYPE_TEXT, /* an array of characters */
    TYPE_PATH, /* a pointer to characters */
    TYPE_NOTHING
};

/* Structures that values arrive in: the scene, and first entries of its lists. */
enum structure {
    OF_SCENE,
    OF_OBJECT,
    OF_PART,
    OF_MESH,
    OF_FEATURE,
    OF_GRID,
    OF_LAYER
};

/* A value that is not the default, where it must arrive, and what else its section then needs. */
static const struct key_case {
    const char *path;
    const char *value;
    enum type type;
    enum structure structure;
    size_t offset; /* bytes from the structure's start */
    double number;
    const char *other; /* NULL: as the row of bases says */
} cases[] = {
#define MEMBER_OF(where, of, type, member) TYPE_##type, where, .offset = offsetof(of, member)
#define S(type, member)                    MEMBER_OF(OF_SCENE, struct scene, type, member)
#define O(type, member)                    MEMBER_OF(OF_OBJECT, sonject_object_params, type, member)
#define P(type, member)                    MEMBER_OF(OF_PART, struct scene_part, type, member)
#define M(type, member)                    MEMBER_OF(OF_MESH, struct mesh, type, member)
#define R(type, member)                    MEMBER_OF(OF_FEATURE, struct relief_feature, type, member)
#define G(type, member)                    MEMBER_OF(OF_GRID, sonject_relief_params, type, member)
#define L(type, index, member)                                                                     \
    TYPE_##type, OF_LAYER,                                                                         \
        .offset = (index) * sizeof(struct water_layer) + offsetof(struct water_layer, member)
#define NOTHING TYPE_NOTHING, .offset = 0
    {"sonject", "1", NOTHING},
    /* test_scene_bands.c tests these two */
    {"band", "high", NOTHING},
    {"bands", "{low: {}}", NOTHING, .other = "band=low"},
    {"input.path", "swath-2.tif", S(PATH, input_path)},
    {"input.channel", "5", S(U32, channel), 5.0},
    {"input.array", "swath", S(PATH, array)},
    {"input.pings", SOURCE_ROOT "/tests/unit/pings.csv", S(U64, pings.count), 3.0},
    {"input.calibration", "auto", S(BOOL, calibrates_itself), 1.0},
    {"input.complex", "true", S(BOOL, input_is_complex), 1.0},
    {"input.uniform.rows", "1048576", S(U32, uniform_rows), 1048576.0},
    {"input.uniform.columns", "7", S(U32, uniform_columns), 7.0},
    {"input.synthetic.rows", "8", S(U32, synthetic.rows), 8.0},
    {"input.synthetic.columns", "9", S(U32, synthetic.columns), 9.0},
    {"input.synthetic.seed", "4294967296", S(U64, synthetic.seed), 4294967296.0},
    {"input.synthetic.complex", "true", S(BOOL, synthetic.complex_pixels), 1.0},
    {"input.synthetic.speckle_shape", "inf", S(DOUBLE, synthetic.speckle_shape), HUGE_VAL},
    {"input.synthetic.texture_length", "35 cm", S(DOUBLE, synthetic.texture_length_m), 0.35},
    {"input.synthetic.ripple_wavelength", "75 cm", S(DOUBLE, synthetic.ripple_wavelength_m), 0.75},
    {"input.synthetic.ripple_contrast", "0.125", S(DOUBLE, synthetic.ripple_contrast), 0.125},
    {"input.synthetic.ripple_heading", "90 deg", S(DOUBLE, synthetic.ripple_heading_rad), PI / 2.0},
    {"input.synthetic.patch_contrast", "6 dB", S(DOUBLE, synthetic.patch_contrast_db), 6.0},
    {"input.synthetic.patch_length", "7 m", S(DOUBLE, synthetic.patch_length_m), 7.0},
    {"input.synthetic.mean_amplitude", "0.5", S(DOUBLE, synthetic.mean_amplitude), 0.5},
    {"input.geometry.row_spacing", "5 cm", S(DOUBLE, geometry.row_spacing_m), 0.05},
    {"input.geometry.row_spacing.speed", "1.5 m/s", S(DOUBLE, geometry.row_spacing_m), 0.075},
    {"input.geometry.row_spacing.ping_rate", "16 Hz", S(DOUBLE, geometry.row_spacing_m), 0.0625},
    {"input.geometry.column_spacing", "15 mm", S(DOUBLE, geometry.column_spacing_m), 0.015},
    {"input.geometry.first_slant_range", "0.043 km", S(DOUBLE, geometry.first_slant_range_m), 43.0},
    {"input.geometry.nadir_column", "203.5", S(DOUBLE, geometry.nadir_column), 203.5},
    {"input.geometry.first_along_track", "-3 m", S(DOUBLE, geometry.first_along_track_m), -3.0},
    {"input.geometry.side", "starboard", S(U32, geometry.side), SONJECT_SIDE_STARBOARD},
    {"input.transfer.kind", "intensity", S(U32, transfer.kind), SONJECT_TRANSFER_INTENSITY},
    {"input.transfer.parameter", "2.2", S(DOUBLE, transfer.parameter), 2.2,
     .other = "input.transfer.kind=gamma"},
    {"input.transfer.offset", "-96 dB", S(DOUBLE, transfer.offset), -96.0,
     .other = "input.transfer={kind: decibel, parameter: 0.378}"},
    {"input.transfer.full_scale", "4095", S(DOUBLE, transfer.full_scale), 4095.0,
     .other = "input.transfer.kind=amplitude"},
    {"patch.row", "3", S(U64, patch.first_row), 3.0},
    {"patch.column", "1099511627776", S(U64, patch.first_column), 1099511627776.0},
    {"patch.rows", "11", S(U64, patch.rows), 11.0},
    {"patch.columns", "12", S(U64, patch.columns), 12.0},
    {"sonar.frequency", "0.3 MHz", S(DOUBLE, sonar.centre_frequency_hz), 300e3},
    {"sonar.bandwidth", "20000 Hz", S(DOUBLE, sonar.bandwidth_hz), 20e3},
    {"sonar.altitude", "12", S(DOUBLE, sonar.altitude_m), 12.0},
    {"sonar.resolution", "3 cm", S(DOUBLE, sonar.along_track_resolution_m), 0.03},
    {"sonar.transducer", "20 cm", S(DOUBLE, sonar.transducer_side_m), 0.2},
    {"sonar.response", "hamming", S(U32, sonar.response_window), SONJECT_WINDOW_HAMMING},
    {"sonar.response.taylor.sidelobes", "40 dB", S(DOUBLE, sonar.taylor_sidelobe_db), 40.0},
    {"sonar.response.taylor.terms", "7", S(U32, sonar.taylor_terms), 7.0},
    {"sonar.kind", "real", S(U32, sonar.kind), SONJECT_SONAR_REAL,
     .other = "sonar.array={length: 1 m}"},
    {"sonar.aperture", "18 deg", S(DOUBLE, sonar.aperture_rad), PI / 10.0},
    {"sonar.array.length", "40 cm", S(DOUBLE, sonar.array_length_m), 0.4},
    {"sonar.array.height", "5 cm", S(DOUBLE, sonar.array_height_m), 0.05},
    {"sonar.array.heading", "-9 deg", S(DOUBLE, sonar.array_heading_rad), -PI / 20.0},
    {"sonar.array.pitch", "9 deg", S(DOUBLE, sonar.array_pitch_rad), PI / 20.0},
    {"sonar.array.depression", "30 deg", S(DOUBLE, sonar.array_depression_rad), PI / 6.0},
    {"sonar.pulse.kind", "chirp", S(U32, pulse.kind), SONJECT_PULSE_CHIRP},
    {"sonar.pulse.window", "hann", S(U32, pulse.window), SONJECT_PULSE_HANN},
    {"sonar.pulse.window.taylor.sidelobes", "40 dB", S(DOUBLE, pulse.taylor_sidelobe_db), 40.0},
    {"sonar.pulse.window.taylor.terms", "7", S(U32, pulse.taylor_terms), 7.0},
    {"sonar.pulse.file", SOURCE_ROOT "/tests/unit/pulse.csv", S(U64, pulse_table.count), 5.0,
     .other = "sonar.pulse={kind: table}"},
    {"sonar.measured_response", SOURCE_ROOT "/tests/unit/cross_range.csv",
     S(U64, cross_range_table.count), 6.0},
    {"sonar.motion.sway[].amplitude", "-2 mm", S(DOUBLE, motion.params.sways[0].amplitude), -0.002},
    {"sonar.motion.sway[].wavelength", "3 m", S(DOUBLE, motion.params.sways[0].wavelength_m), 3.0},
    {"sonar.motion.sway[].phase", "2 rad", S(DOUBLE, motion.params.sways[0].phase_rad), 2.0},
    {"sonar.motion.random.rms", "1 mm", S(DOUBLE, motion.params.random_rms_m), 0.001},
    {"sonar.motion.random.correlation", "2 m", S(DOUBLE, motion.params.random_correlation_m), 2.0},
    {"sonar.motion.random.seed", "9", S(U64, motion.params.seed), 9.0},
    {"sonar.motion.file", SOURCE_ROOT "/tests/unit/sway.csv", S(U64, motion.sway_table.count), 3.0},
    {"sonar.motion.yaw.advance", "40 cm", S(DOUBLE, motion.params.yaw_advance_m), 0.4},
    {"sonar.motion.yaw.bias", "-0.009 rad", S(DOUBLE, motion.params.yaw_bias_rad), -0.009},
    {"sonar.motion.yaw.sines[].amplitude", "-0.02 rad", S(DOUBLE, motion.params.yaws[0].amplitude),
     -0.02},
    {"sonar.motion.yaw.sines[].wavelength", "3 m", S(DOUBLE, motion.params.yaws[0].wavelength_m),
     3.0},
    {"sonar.motion.yaw.sines[].phase", "2 rad", S(DOUBLE, motion.params.yaws[0].phase_rad), 2.0},
    {"sonar.motion.yaw.random.rms", "0.01 rad", S(DOUBLE, motion.params.yaw_random_rms_rad), 0.01},
    {"sonar.motion.yaw.random.correlation", "2 m",
     S(DOUBLE, motion.params.yaw_random_correlation_m), 2.0},
    {"sonar.motion.yaw.random.seed", "9", S(U64, motion.params.yaw_seed), 9.0},
    {"sonar.motion.yaw.file", SOURCE_ROOT "/tests/unit/yaw.csv", S(U64, motion.yaw_table.count),
     2.0},
    {"medium.sound_speed", "1.48 km/s", S(DOUBLE, medium.sound_speed_mps), 1480.0},
    {"medium.reference_sound_speed", "1490 m/s", S(DOUBLE, medium.reference_sound_speed_mps),
     1490.0},
    {"medium.absorption", "0.03 dB/m", S(DOUBLE, medium.absorption_db_per_m), 0.03},
    /* test_scene_medium.c tests the absorption that these four give */
    {"medium.absorption.temperature", "12 C", NOTHING},
    {"medium.absorption.salinity", "35", NOTHING},
    {"medium.absorption.depth", "20 m", NOTHING},
    {"medium.absorption.ph", "7.7", NOTHING},
    {"medium.layers[].bottom", "12 m", L(DOUBLE, 1, bottom_m), 12.0},
    {"medium.layers[].sound_speed", "1.51 km/s", L(DOUBLE, 1, speed_mps), 1510.0},
    {"medium.layers[].density", "1.02 g/cm3", L(DOUBLE, 1, density), 1020.0},
    {"medium.profile.file", SOURCE_ROOT "/tests/unit/cast.csv", L(DOUBLE, 1, bottom_m), 3.0},
    {"medium.profile.heights", "[4 m, 12 m]", L(DOUBLE, 1, bottom_m), 4.0},
    {"medium.profile.depths", "[8 m, 15 m]", L(DOUBLE, 1, bottom_m), 5.0,
     .other = "medium.profile={sound_speeds: [1500, 1490]}"},
    {"medium.profile.sound_speeds", "[1.48 km/s, 1500]", L(DOUBLE, 0, speed_mps), 1480.0},
    {"seabed.lambert", "0.25", S(DOUBLE, seabed.lambert), 0.25},
    {"seabed.sediment", "medium_sand", S(DOUBLE, seabed.grain_size_phi), 1.5},
    {"seabed.sediment.grain_size", "4.25", S(DOUBLE, seabed.grain_size_phi), 4.25},
    {"seabed.map", "despeckled", S(U32, seabed.map), SONJECT_MAP_DESPECKLED},
    {"surface.depth", "20 m", S(DOUBLE, surface.water_depth_m), 20.0},
    {"surface.reflection", "-0.9", S(DOUBLE, surface.material.reflection), -0.9},
    {"surface.roughness", "5 cm", S(DOUBLE, surface.material.roughness_m), 0.05},
    {"surface.lambert", "0.1", S(DOUBLE, surface.material.lambert), 0.1},
    {"surface.exponent", "2", S(DOUBLE, surface.material.lambert_exponent), 2.0},
    {"surface.glossy.albedo", "0.5", S(DOUBLE, surface.material.glossy_albedo), 0.5},
    {"surface.glossy.slope", "0.1", S(DOUBLE, surface.material.glossy_slope), 0.1},
    {"seabed.level_radius", "4 m", S(DOUBLE, seabed.level_radius_m), 4.0},
    {"seabed.despeckle_radius", "5 cm", S(DOUBLE, seabed.despeckle_radius_m), 0.05},
    {"seabed.relief[].heights.file", HEIGHTS, G(U32, columns), 3.0,
     .other = RELIEF("heights: {unit: cm, " H_GRID "}")},
    {"seabed.relief[].heights.array", "depths", G(U32, columns), 3.0,
     .other = RELIEF("heights: {file: '" ARRAYS "', unit: cm, " H_GRID "}")},
    {"seabed.relief[].heights.unit", "10 cm", NOTHING},
    {"seabed.relief[].heights.positive", "down", NOTHING},
    {"seabed.relief[].heights.offset", "-20 cm", NOTHING},
    {"seabed.relief[].heights.row_spacing", "50 cm", G(DOUBLE, row_spacing_m), 0.5},
    {"seabed.relief[].heights.column_spacing", "25 cm", G(DOUBLE, column_spacing_m), 0.25},
    {"seabed.relief[].heights.first_ground_range", "38 m", G(DOUBLE, first_ground_range_m), 38.0},
    {"seabed.relief[].heights.first_along_track", "-2 m", G(DOUBLE, first_along_track_m), -2.0},
    {"seabed.relief[].ripples.wavelength", "40 cm", R(DOUBLE, wavelength_m), 0.4},
    {"seabed.relief[].ripples.height", "4 cm", R(DOUBLE, height_m), 0.04},
    {"seabed.relief[].ripples.heading", "90 deg", R(DOUBLE, heading_rad), PI / 2.0},
    {"seabed.relief[].ripples.phase", "90 deg", R(DOUBLE, phase_rad), PI / 2.0},
    {"seabed.relief[].ripples.sharpness", "0.5", R(DOUBLE, sharpness), 0.5},
    {"seabed.relief[].ripples.irregularity", "0.25", R(DOUBLE, irregularity), 0.25},
    {"seabed.relief[].ripples.seed", "9", R(U64, seed), 9.0},
    {"seabed.relief[].mound.position", "centre", R(U32, position_kind),
     SONJECT_POSITION_PATCH_CENTRE},
    {"seabed.relief[].mound.position.along_track", "2 m", R(DOUBLE, position_along), 2.0,
     .other = RELIEF("mound: {" A_MOUND ", position: {slant_range: 41}}")},
    {"seabed.relief[].mound.position.slant_range", "42 m", R(DOUBLE, position_range), 42.0,
     .other = RELIEF("mound: {" A_MOUND ", position: {along_track: 1}}")},
    {"seabed.relief[].mound.position.row", "2.5", R(DOUBLE, position_along), 2.5,
     .other = RELIEF("mound: {" A_MOUND ", position: {column: 3}}")},
    {"seabed.relief[].mound.position.column", "3.5", R(DOUBLE, position_range), 3.5,
     .other = RELIEF("mound: {" A_MOUND ", position: {row: 3}}")},
    {"seabed.relief[].mound.radius", "2 m", R(DOUBLE, radius_m), 2.0},
    {"seabed.relief[].mound.height", "30 cm", R(DOUBLE, height_m), 0.3},
    {"seabed.relief[].pit.depth", "30 cm", R(DOUBLE, height_m), 0.3},
    {"seabed.relief[].scour.object", "can", R(TEXT, object)},
    {"seabed.relief[].scour.width", "60 cm", R(DOUBLE, width_m), 0.6},
    {"seabed.relief[].scour.depth", "6 cm", R(DOUBLE, height_m), 0.06},
    {"seabed.forward", "medium sand", S(U32, seabed.forward.reflection_kind),
     SONJECT_REFLECTION_FLUID},
    {"seabed.forward.sediment", "silt", S(U32, seabed.forward.reflection_kind),
     SONJECT_REFLECTION_FLUID},
    {"seabed.forward.rule", "map", S(U32, seabed.forward_rule), SONJECT_FORWARD_MAP},
    {"seabed.forward.reflection", "0.25", S(DOUBLE, seabed.forward.reflection), 0.25},
    {"seabed.forward.roughness", "5 mm", S(DOUBLE, seabed.forward.roughness_m), 0.005},
    {"seabed.forward.lambert", "0.125", S(DOUBLE, seabed.forward.lambert), 0.125},
    {"seabed.forward.exponent", "2", S(DOUBLE, seabed.forward.lambert_exponent), 2.0},
    {"seabed.forward.glossy.albedo", "0.5", S(DOUBLE, seabed.forward.glossy_albedo), 0.5},
    {"seabed.forward.glossy.slope", "0.25", S(DOUBLE, seabed.forward.glossy_slope), 0.25},
    {"seabed.forward.fluid.density", "1.5", S(DOUBLE, seabed.forward.density_ratio), 1.5},
    {"seabed.forward.fluid.speed", "1.25", S(DOUBLE, seabed.forward.speed_ratio), 1.25},
    {"seabed.forward.fluid.loss", "0.125", S(DOUBLE, seabed.forward.loss), 0.125},
    {"injection.mode", "resynthesise", S(U32, injection.mode), SONJECT_MODE_RESYNTHESISE},
    {"injection.columns", "paper", S(U32, injection.column_rule), SONJECT_COLUMNS_PAPER},
    {"injection.noise_floor", "-30 dB", S(DOUBLE, injection.noise_floor_db), -30.0},
    {"injection.noise_floor_over", "-12 dB", S(DOUBLE, injection.noise_floor_over_db), -12.0},
    {"injection.influence", "-35 dB", S(DOUBLE, injection.influence_db), -35.0},
    {"injection.rays", "0.5", S(DOUBLE, injection.ray_scale), 0.5},
    {"injection.accuracy", "2 %", S(DOUBLE, injection.accuracy), 0.02},
    {"injection.seed", "2199023255552", S(U64, injection.seed), 2199023255552.0},
    {"injection.interactions", "3", S(U32, injection.interactions), 3.0},
    {"injection.estimator", "brute_force", S(U32, injection.estimator),
     SONJECT_ESTIMATOR_BRUTE_FORCE, .other = "injection.mode=resynthesise"},
    {"elements.pings.count", "250", S(U32, elements.pings), 250.0},
    {"elements.pings.first", "-3.5 m", S(DOUBLE, elements.first_ping_m), -3.5},
    {"elements.pings.spacing", "10 cm", S(DOUBLE, elements.ping_spacing_m), 0.1},
    {"elements.transmitter.offset", "-0.2 m", S(DOUBLE, elements.transmitter_offset_m), -0.2},
    {"elements.transmitter.length", "5 cm", S(DOUBLE, elements.transmitter_length_m), 0.05},
    {"elements.hydrophones.count", "16", S(U32, elements.hydrophones), 16.0},
    {"elements.hydrophones.first", "0.3 m", S(DOUBLE, elements.first_hydrophone_m), 0.3},
    {"elements.hydrophones.spacing", "4 cm", S(DOUBLE, elements.hydrophone_spacing_m), 0.04},
    {"elements.hydrophones.length", "0", S(DOUBLE, elements.hydrophone_length_m), 0.0},
    {"elements.form", "passband", S(U32, elements.form), SONJECT_SERIES_PASSBAND},
    {"elements.pulse", "chirp", S(U32, elements.pulse), SONJECT_SERIES_CHIRP},
    {"elements.chirp", "20 ms", S(DOUBLE, elements.chirp_duration_s), 0.02},
    {"elements.sampling_rate", "70 kHz", S(DOUBLE, elements.sampling_rate_hz), 70e3},
    {"elements.source_level", "220 dB", S(DOUBLE, elements.source_level_db), 220.0},
    {"elements.first_time", "50 ms", S(DOUBLE, elements.first_time_s), 0.05},
    {"elements.last_time", "70 ms", S(DOUBLE, elements.last_time_s), 0.07},
    {"elements.aspect_limit", "0.25 rad", S(DOUBLE, elements.aspect_limit_rad), 0.25},
    {"injection.match.response", "nominal", S(U32, injection.match_response), 0.0},
    {"injection.match.looks", "2.5", S(DOUBLE, injection.match_looks), 2.5},
    {"injection.match.saturation", "full_scale", S(U32, injection.match_saturation), 0.0},
    {"injection.order_energies", "true", S(BOOL, injection.order_energies), 1.0},
    {"objects[].name", "M\xC3\xBCll 7: #1", O(TEXT, name)},
    {"objects[].class", "mine", O(TEXT, class_name)},
    {"objects[].shape", "capsule", O(U32, shape), SHAPE_CAPSULE, .other = "objects[0].length=2 m"},
    {"objects[].length", "1.2 m", O(DOUBLE, length_m), 1.2, .other = "objects[0].shape=cylinder"},
    {"objects[].width", "0.8 m", O(DOUBLE, width_m), 0.8,
     .other = "objects[0]={shape: plane, length: 1 m}"},
    {"objects[].diameter", "30 cm", O(DOUBLE, diameter_m), 0.3},
    {"objects[].height", "25 cm", O(DOUBLE, height_m), 0.25, .other = "objects[0].shape=cone"},
    {"objects[].top_diameter", "20 cm", O(DOUBLE, top_diameter_m), 0.2,
     .other = "objects[0]={shape: truncated_cone, diameter: 1, height: 0.5}"},
    {"objects[].front_height", "10 cm", O(DOUBLE, front_height_m), 0.1,
     .other = "objects[0]={shape: wedge, length: 1, width: 1, height: 0.5}"},
    {"objects[].nose_end", "open", O(U32, nose_end), SONJECT_END_OPEN},
    {"objects[].nose_end.depth", "10 cm", O(DOUBLE, nose_end_depth_m), 0.1},
    {"objects[].tail_end", "spherical", O(U32, tail_end), SONJECT_END_SPHERICAL},
    {"objects[].tail_end.depth", "10 cm", O(DOUBLE, tail_end_depth_m), 0.1},
    {"objects[].burial.fraction", "0.25", O(DOUBLE, burial_fraction), 0.25},
    {"objects[].level", "physical", O(U32, level_kind), 0.0},
    {"objects[].level.target_strength", "-20 dB", O(DOUBLE, level_db), -20.0},
    {"objects[].level.over_seabed", "12 dB", O(DOUBLE, level_db), 12.0},
    {"objects[].fouling.albedo", "6 dB", O(DOUBLE, fouling.albedo_db), 6.0},
    {"objects[].fouling.albedo_length", "30 cm", O(DOUBLE, fouling.albedo_length_m), 0.3},
    {"objects[].fouling.relief", "4 mm", O(DOUBLE, fouling.relief_m), 0.004},
    {"objects[].fouling.relief_length", "8 cm", O(DOUBLE, fouling.relief_length_m), 0.08},
    {"objects[].burial.proud", "20 cm", O(DOUBLE, proud_height_m), 0.2},
    {"objects[].position", "centre", O(U32, position_kind), SONJECT_POSITION_PATCH_CENTRE},
    {"objects[].position.along_track", "-2 m", O(DOUBLE, position_along), -2.0,
     .other = "objects[0].position={slant_range: 41}"},
    {"objects[].position.slant_range", "42 m", O(DOUBLE, position_range), 42.0,
     .other = "objects[0].position={along_track: 0}"},
    {"objects[].position.row", "1.5", O(DOUBLE, position_along), 1.5,
     .other = "objects[0].position={column: 2}"},
    {"objects[].position.column", "2.25", O(DOUBLE, position_range), 2.25,
     .other = "objects[0].position={row: 2}"},
    {"objects[].heading", "-45 deg", O(DOUBLE, heading_rad), -PI / 4.0},
    {"objects[].pitch", "0.5 rad", O(DOUBLE, pitch_rad), 0.5},
    {"objects[].roll", "180", O(DOUBLE, roll_rad), PI},
    {"objects[].burial", "-6.7 cm", O(DOUBLE, burial_m), -0.067},
    {"objects[].material.reflection", "-0.75", O(DOUBLE, material.reflection), -0.75},
    {"objects[].material.roughness", "2 mm", O(DOUBLE, material.roughness_m), 0.002},
    {"objects[].material.lambert", "0.125", O(DOUBLE, material.lambert), 0.125},
    {"objects[].material", "gravel", O(U32, material.reflection_kind), SONJECT_REFLECTION_FLUID},
    {"objects[].material.name", "fine-sand", O(U32, material.reflection_kind),
     SONJECT_REFLECTION_FLUID},
    {"objects[].material.exponent", "4", O(DOUBLE, material.lambert_exponent), 4.0},
    {"objects[].material.glossy.albedo", "0.25", O(DOUBLE, material.glossy_albedo), 0.25},
    {"objects[].material.glossy.slope", "0.5", O(DOUBLE, material.glossy_slope), 0.5},
    {"objects[].material.fluid.density", "8", O(DOUBLE, material.density_ratio), 8.0},
    {"objects[].material.fluid.speed", "4", O(DOUBLE, material.speed_ratio), 4.0},
    {"objects[].material.fluid.loss", "0.0625", O(DOUBLE, material.loss), 0.0625},
    {"objects[].target", SOURCE_ROOT "/tools/targets/oil_drum.yaml", O(U32, shape), SHAPE_PARTS,
     .other = "objects[0]={}"},
    {"objects[].parts[].name", "left ear", P(TEXT, shape.name)},
    {"objects[].parts[].shape", "disc", P(U32, shape.shape), SHAPE_DISC},
    {"objects[].parts[].diameter", "30 cm", P(DOUBLE, shape.diameter_m), 0.3},
    {"objects[].mesh", SOLID, M(PATH, name), .other = "objects[0]={shape: mesh}"},
    {"objects[].mesh.file", SOLID, M(PATH, name), .other = "objects[0]={shape: mesh}"},
    {"objects[].mesh.unit", "cm", M(DOUBLE, options.unit_m), 0.01},
    {"objects[].mesh.nose", "y", M(U32, options.axes[0]), 2.0},
    {"objects[].mesh.up", "y", M(U32, options.axes[2]), 2.0},
    {"objects[].mesh.open", "true", NOTHING},
    {"objects[].mesh.smooth", "90 deg", M(DOUBLE, options.smooth_angle_rad), PI / 2.0},
    {"objects[].parts[].mesh", SOLID, M(PATH, name), .other = A_PART("shape: mesh")},
    {"objects[].parts[].at.along", "20 cm", P(DOUBLE, centre[0]), 0.2},
    {"objects[].parts[].at.across", "-3 m", P(DOUBLE, centre[1]), -3.0},
    {"objects[].parts[].at.up", "1.5 m", P(DOUBLE, centre[2]), 1.5},
    /* right angles: the sine is 1 */
    {"objects[].parts[].heading", "90 deg", P(DOUBLE, axes[0][1]), 1.0},
    {"objects[].parts[].pitch", "90 deg", P(DOUBLE, axes[0][2]), 1.0},
    {"objects[].parts[].roll", "90 deg", P(DOUBLE, axes[1][2]), 1.0},
    {"objects[].parts[].parts", "[{shape: sphere, diameter: 0.75}]", P(DOUBLE, shape.diameter_m),
     0.75, .other = A_PART("name: group")},
    {"objects[].parts[].material.reflection", "-0.75", P(DOUBLE, shape.material.reflection), -0.75},
    {"objects[].parts[].material", "gravel", P(U32, shape.material.reflection_kind),
     SONJECT_REFLECTION_FLUID},
};

/* Returns all keys, for json_decref. */
static inline json_t *list_keys(void)
{
    struct report report = {.host = NULL};
    char *text;
    assert_int_equal(section_keys_json(&report, &scene_section, &text), SONJECT_OK);
    json_t *keys = json_loads(text, 0, NULL);
    assert_true(json_is_array(keys));
    free(text);
    return keys;
}

/* Returns a text that is said of a key; "" for null. */
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

static inline const void *structure_of(const struct scene *scene, const struct key_case *key)
{
    const void *const structures[] = {[OF_SCENE] = scene,
                                      [OF_OBJECT] = scene->objects,
                                      [OF_PART] = scene->parts,
                                      [OF_MESH] = scene->meshes,
                                      [OF_FEATURE] = scene->relief.features,
                                      [OF_GRID] = &scene->relief.grid,
                                      [OF_LAYER] = scene->water_layers};
    return structures[key->structure];
}

/* Writes an override, with an index for each list of its path: the second layer, else the first. */
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

/* Returns a key's row of bases; NULL: none. */
static inline const struct base *base_of(const struct key_case *key)
{
    char path[100];
    snprintf(path, sizeof path, "%s ", key->path);
    for (size_t i = 0; i < COUNT(bases); i++)
        if (strncmp(path, bases[i].path, strlen(bases[i].path)) == 0)
            return &bases[i];
    return NULL;
}

/* Returns whether a key has a case, or shares one with a like section: parts with objects, pits
 * with mounds. */
static inline bool has_case(const char *path)
{
    static const char *const alike[][2] = {{"objects[].parts[].", "objects[]."},
                                           {"seabed.relief[].pit.", "seabed.relief[].mound."}};
    char other[140];
    for (size_t i = 0; i < COUNT(cases); i++)
        if (strcmp(cases[i].path, path) == 0)
            return true;
    for (size_t i = 0; i < COUNT(alike); i++) {
        const size_t length = strlen(alike[i][0]);
        if (strncmp(path, alike[i][0], length) != 0)
            continue;
        snprintf(other, sizeof other, "%s%.100s", alike[i][1], path + length);
        return has_case(other);
    }
    return false;
}

/* Reads the case's scene with a value of its key; NULL: without the key. */
static inline sonject_status read_case(const struct key_case *key, const char *value)
{
    char override[1400];
    const char *overrides[2];
    size_t count = 0;
    const struct base *base = base_of(key);
    const char *text = base && base->text ? base->text : small;
    const char *other = key->other || !base ? key->other : base->other;
    if (other)
        overrides[count++] = other;
    if (value) {
        write_override(override, sizeof override, key, value);
        overrides[count++] = override;
    }
    return read_scene_text(text, overrides, count);
}

#endif
