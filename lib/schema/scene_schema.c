/* The tables. A line: key, meaning, what it is, where it goes. */
#include "schema/scene_bands.h"
#include "schema/scene_fields.h"
#include "swath/xtf_file.h"

#define SIDE_MAX  (UINT64_C(1) << 20)
#define INDEX_MAX (UINT64_C(1) << 40)

static const struct field uniform_fields[] = {
    {"rows", "track positions", COUNT32(struct scene, uniform_rows, SIDE_MAX), REQUIRED},
    {"columns", "range cells", COUNT32(struct scene, uniform_columns, SIDE_MAX), REQUIRED},
};
static const struct section uniform_section = {uniform_fields, COUNT(uniform_fields),
                                               finish_uniform};

#define STRUCTURE sonject_synthetic_params
static const struct field synthetic_fields[] = {
    {"rows", "track positions", COUNT32(STRUCTURE, rows, SIDE_MAX), REQUIRED},
    {"columns", "range cells", COUNT32(STRUCTURE, columns, SIDE_MAX), REQUIRED},
    {"seed", "of the random seabed", COUNT64(STRUCTURE, seed, UINT64_MAX)},
    {"complex", "complex pixels instead of amplitudes", .kind = FIELD_FLAG32,
     .offset = offsetof(STRUCTURE, complex_pixels)},
    {"speckle_shape", "shape of the K distribution, inf for Rayleigh amplitudes",
     QUANTITY(STRUCTURE, speckle_shape, QUANTITY_NUMBER)},
    {"texture_length", "correlation length of the speckle's texture",
     QUANTITY(STRUCTURE, texture_length_m, QUANTITY_LENGTH)},
    {"ripple_wavelength", "from crest to crest of the sand ripples",
     QUANTITY(STRUCTURE, ripple_wavelength_m, QUANTITY_LENGTH)},
    {"ripple_contrast", "of the ripples, 0 (none) to 1",
     QUANTITY(STRUCTURE, ripple_contrast, QUANTITY_NUMBER)},
    {"ripple_heading", "direction across the crests, from along-track towards range",
     QUANTITY(STRUCTURE, ripple_heading_rad, QUANTITY_ANGLE)},
    {"patch_contrast", "level step between sediment patches",
     QUANTITY(STRUCTURE, patch_contrast_db, QUANTITY_DECIBEL)},
    {"patch_length", "typical size of a sediment patch",
     QUANTITY(STRUCTURE, patch_length_m, QUANTITY_LENGTH)},
    {"mean_amplitude", "rms amplitude of the darker sediment",
     QUANTITY(STRUCTURE, mean_amplitude, QUANTITY_NUMBER)},
};
static const struct section synthetic_section = {synthetic_fields, COUNT(synthetic_fields),
                                                 finish_synthetic};
#undef STRUCTURE

#define STRUCTURE sonject_geometry_params
static const struct field geometry_fields[] = {
    {"row_spacing", "distance between track positions, or the speed and ping_rate that make it",
     QUANTITY(STRUCTURE, row_spacing_m, QUANTITY_LENGTH), .read = read_row_spacing,
     .section = &ping_spacing_section, .unit = "m, km, cm, mm, or {speed, ping_rate}", REQUIRED},
    {"column_spacing", "distance between range cells, in slant range",
     QUANTITY(STRUCTURE, column_spacing_m, QUANTITY_LENGTH), REQUIRED},
    {"first_slant_range", "slant range of column 0 of the whole swath",
     QUANTITY(STRUCTURE, first_slant_range_m, QUANTITY_LENGTH), REQUIRED},
    {"first_along_track", "track position of row 0",
     QUANTITY(STRUCTURE, first_along_track_m, QUANTITY_LENGTH)},
    {"side", "of the track that the image shows",
     WORD(STRUCTURE,
          side) = {[SONJECT_SIDE_PORT] = "port", [SONJECT_SIDE_STARBOARD] = "starboard"}},
};
const struct section geometry_section = {geometry_fields, COUNT(geometry_fields), finish_geometry};
#undef STRUCTURE

#define STRUCTURE sonject_transfer_params
static const struct field transfer_fields[] = {
    {"kind", "how stored numbers came from amplitudes",
     WORD(STRUCTURE, kind) = {[SONJECT_TRANSFER_AMPLITUDE] = "amplitude",
                              [SONJECT_TRANSFER_INTENSITY] = "intensity",
                              [SONJECT_TRANSFER_DECIBEL] = "decibel",
                              [SONJECT_TRANSFER_GAMMA] = "gamma",
                              [SONJECT_TRANSFER_SCHLICK] = "schlick"},
     REQUIRED},
    {"parameter", "dB per stored unit (decibel), exponent (gamma) or b (schlick)",
     QUANTITY(STRUCTURE, parameter, QUANTITY_NUMBER)},
    {"offset", "level of a stored 0 (decibel)", QUANTITY(STRUCTURE, offset, QUANTITY_DECIBEL)},
    {"full_scale", "largest value that the recorder stores; by default the pixel type's",
     QUANTITY(STRUCTURE, full_scale, QUANTITY_NUMBER)},
};
static const struct section transfer_section = {transfer_fields, COUNT(transfer_fields),
                                                finish_transfer};
#undef STRUCTURE

#define STRUCTURE struct scene
static const struct field input_fields[] = {
    {"path", "image file", .kind = FIELD_PATH, .offset = offsetof(STRUCTURE, input_path)},
    {"channel", "of an XTF file: port, starboard, or its number there",
     COUNT32(STRUCTURE, channel, XTF_CHANNEL_MAX), .read = read_channel,
     .unit = "word or whole number"},
    {"array", "in an HDF5 or MATLAB file of several: its name", TEXT(STRUCTURE, array)},
    {"complex", "the file's two channels are real and imaginary part", .kind = FIELD_BOOL,
     .offset = offsetof(STRUCTURE, input_is_complex)},
    {"uniform", "a swath of unit reflectivity", SAME(uniform_section)},
    {"synthetic", "a swath that sonject makes", PART(STRUCTURE, synthetic, synthetic_section)},
    {"geometry",
     "where the pixels lie: row_spacing, column_spacing and first_slant_range, or from_file",
     PART(STRUCTURE, geometry, geometry_section), .read = read_geometry, REQUIRED},
    {"transfer", "what the file's numbers mean", PART(STRUCTURE, transfer, transfer_section)},
};
const struct section input_section = {input_fields, COUNT(input_fields), finish_input};
#undef STRUCTURE

#define STRUCTURE sonject_patch_params
static const struct field patch_fields[] = {
    {"row", "first row of the swath", COUNT64(STRUCTURE, first_row, INDEX_MAX)},
    {"column", "first column of the swath", COUNT64(STRUCTURE, first_column, INDEX_MAX)},
    {"rows", "track positions", COUNT64(STRUCTURE, rows, INDEX_MAX), REQUIRED},
    {"columns", "range cells", COUNT64(STRUCTURE, columns, INDEX_MAX), REQUIRED},
};
const struct section patch_section = {patch_fields, COUNT(patch_fields), finish_patch};
#undef STRUCTURE

#define STRUCTURE sonject_sonar_params
static const struct field taylor_fields[] = {
    {"sidelobes", "depth of the side lobes",
     QUANTITY(STRUCTURE, taylor_sidelobe_db, QUANTITY_DECIBEL), REQUIRED},
    {"terms", "side lobes of equal height", COUNT32(STRUCTURE, taylor_terms, UINT32_MAX), REQUIRED},
};
static const struct section taylor_section = {taylor_fields, COUNT(taylor_fields), NULL};

static const struct field response_fields[] = {
    {"taylor", "sidelobes and terms of a Taylor window", SAME(taylor_section), REQUIRED},
};
static const struct section response_section = {response_fields, COUNT(response_fields),
                                                finish_response};

static const struct field array_fields[] = {
    {"length", "along the track; sets the beam",
     QUANTITY(STRUCTURE, array_length_m, QUANTITY_LENGTH), REQUIRED},
    {"height", "across; 0 hears all elevations alike",
     QUANTITY(STRUCTURE, array_height_m, QUANTITY_LENGTH)},
    {"heading", "of the long side, from along-track towards range",
     QUANTITY(STRUCTURE, array_heading_rad, QUANTITY_ANGLE)},
    {"pitch", "of the long side over the horizontal",
     QUANTITY(STRUCTURE, array_pitch_rad, QUANTITY_ANGLE)},
    {"depression", "of the beam below the horizontal",
     QUANTITY(STRUCTURE, array_depression_rad, QUANTITY_ANGLE)},
};
static const struct section array_section = {array_fields, COUNT(array_fields), NULL};

static const struct field sonar_fields[] = {
    {"frequency", "centre frequency", QUANTITY(STRUCTURE, centre_frequency_hz, QUANTITY_FREQUENCY),
     REQUIRED},
    {"bandwidth", "sets the range resolution, c / (2 bandwidth)",
     QUANTITY(STRUCTURE, bandwidth_hz, QUANTITY_FREQUENCY), REQUIRED},
    {"altitude", "height of the track over the mean seabed, or from_file",
     QUANTITY(STRUCTURE, altitude_m, QUANTITY_LENGTH), .read = read_altitude,
     .unit = "m, km, cm, mm, or from_file", REQUIRED},
    {"resolution", "along-track; by default the row spacing",
     QUANTITY(STRUCTURE, along_track_resolution_m, QUANTITY_LENGTH)},
    {"transducer", "side of the source, 0 for a point",
     QUANTITY(STRUCTURE, transducer_side_m, QUANTITY_LENGTH)},
    {"response", "aspect weighting: rectangular, hamming or {taylor: {sidelobes: , terms: }}",
     WORD(STRUCTURE, response_window) =
         {[SONJECT_WINDOW_RECTANGULAR] = "rectangular", [SONJECT_WINDOW_HAMMING] = "hamming"},
     .section = &response_section},
    {"kind", "synthetic aperture, or the real one of a sidescan",
     WORD(STRUCTURE,
          kind) = {[SONJECT_SONAR_SYNTHETIC] = "synthetic", [SONJECT_SONAR_REAL] = "real"}},
    {"aperture", "full angle of the aspects that shadows and rough highlights take, auto or none",
     QUANTITY(STRUCTURE, aperture_rad, QUANTITY_ANGLE), .read = read_aperture,
     .unit = "deg, auto or none"},
    {"array", "of a real aperture", SAME(array_section)},
    {"pulse", "what a point looks like in range; by default Gaussian", .kind = FIELD_SPECIAL,
     .section = &pulse_section, .read = read_pulse},
    {"measured_response", "along-track, a table with columns along_track_m, real, and imaginary",
     .kind = FIELD_SPECIAL, .read = read_cross_range, .unit = "file name"},
    {"motion", "residual motion of a synthetic aperture's sonar", .kind = FIELD_SPECIAL,
     .section = &motion_section, .read = read_motion},
};
const struct section sonar_section = {sonar_fields, COUNT(sonar_fields), finish_recording};
#undef STRUCTURE

#define STRUCTURE sonject_seabed_params
static const struct field seabed_fields[] = {
    {"lambert", "backscatter mu at normal incidence, -27 dB on Mackenzie's seabed",
     QUANTITY(STRUCTURE, lambert, QUANTITY_LEVEL)},
    {"map", "reflectivity that resynthesise takes from the image",
     WORD(STRUCTURE, map) = {[SONJECT_MAP_INTENSITY] = "intensity",
                             [SONJECT_MAP_DESPECKLED] = "despeckled",
                             [SONJECT_MAP_COHERENT] = "coherent"}},
    {"level_radius", "of the local mean that lambert stands for",
     QUANTITY(STRUCTURE, level_radius_m, QUANTITY_LENGTH)},
    {"despeckle_radius", "of the despeckled map's local mean",
     QUANTITY(STRUCTURE, despeckle_radius_m, QUANTITY_LENGTH)},
    {"forward", "surface for sound that does not go straight back: a sediment's name, or a section",
     .kind = FIELD_NAMED, .offset = 0, .section = &forward_section, .read = read_sediment_name},
    {"relief",
     "list of ripples, mounds, pits, scour and heights, added together; by default all is level",
     .kind = FIELD_SPECIAL, .section = &relief_section, .is_list = true, .read = read_relief},
};
const struct section seabed_section = {seabed_fields, COUNT(seabed_fields), finish_seabed};
#undef STRUCTURE

#define STRUCTURE sonject_material_params
static const struct field waves_fields[] = {
    {"albedo", "fraction that the cone returns at most, by default what lambert leaves",
     QUANTITY(STRUCTURE, glossy_albedo, QUANTITY_NUMBER)},
    {"slope", "rms slope of the waves, which make the cone",
     QUANTITY(STRUCTURE, glossy_slope, QUANTITY_NUMBER)},
};
static const struct section waves_section = {waves_fields, COUNT(waves_fields), NULL};
#undef STRUCTURE

#define STRUCTURE sonject_surface_params
static const struct field surface_fields[] = {
    {"depth", "of the water: height of the surface over the mean seabed",
     QUANTITY(STRUCTURE, water_depth_m, QUANTITY_LENGTH), REQUIRED},
    {"reflection", "amplitude of the mirror-like part, -1 to 1",
     QUANTITY(STRUCTURE, material.reflection, QUANTITY_NUMBER)},
    {"roughness", "rms height of the waves",
     QUANTITY(STRUCTURE, material.roughness_m, QUANTITY_LENGTH)},
    {"lambert", "coefficient mu of the rough part",
     QUANTITY(STRUCTURE, material.lambert, QUANTITY_LEVEL)},
    {"exponent", "of the rough part's cosines, 1 for Lambert's law",
     QUANTITY(STRUCTURE, material.lambert_exponent, QUANTITY_NUMBER)},
    {"glossy", "cone about the mirror direction", PART(STRUCTURE, material, waves_section)},
};
const struct section surface_section = {surface_fields, COUNT(surface_fields), finish_surface};
#undef STRUCTURE

#define STRUCTURE sonject_injection_params
static const struct field match_fields[] = {
    {"response", "widths of the point response: the image's around the targets, or the sonar's",
     WORD(STRUCTURE,
          match_response) = {[SONJECT_MATCH_NOMINAL] = "nominal", [SONJECT_MATCH_IMAGE] = "image"}},
    {"looks", "averaged in a magnitude pixel: image, or 1 to 64",
     QUANTITY(STRUCTURE, match_looks, QUANTITY_NUMBER), .read = read_match_looks,
     .unit = "number, or image"},
    {"saturation", "amplitude that cuts highlights: the image's own, or the file's full scale",
     WORD(STRUCTURE, match_saturation) =
         {[SONJECT_MATCH_NOMINAL] = "full_scale", [SONJECT_MATCH_IMAGE] = "image"}},
};
static const struct section match_section = {match_fields, COUNT(match_fields), NULL};

static const struct field injection_fields[] = {
    {"mode", "keep the measured pixels around the target, or trace the patch anew",
     WORD(STRUCTURE, mode) =
         {[SONJECT_MODE_COMPOSITE] = "composite", [SONJECT_MODE_RESYNTHESISE] = "resynthesise"}},
    {"columns", "that an echo of several interactions goes to",
     WORD(
         STRUCTURE,
         column_rule) = {[SONJECT_COLUMNS_FOCUSED] = "focused", [SONJECT_COLUMNS_PAPER] = "paper"}},
    {"noise_floor", "noise over the mean seabed, or estimate",
     QUANTITY(STRUCTURE, noise_floor_db, QUANTITY_DECIBEL), .read = read_noise_floor,
     .unit = "dB, or estimate"},
    {"influence", "change over the seabed from which a pixel is the target's",
     QUANTITY(STRUCTURE, influence_db, QUANTITY_DECIBEL)},
    {"rays", "factor on the number of rays", QUANTITY(STRUCTURE, ray_scale, QUANTITY_NUMBER)},
    {"seed", "of all random numbers of the injection", COUNT64(STRUCTURE, seed, UINT64_MAX)},
    {"interactions", "surfaces that a path may meet, 1 to 8",
     COUNT32(STRUCTURE, interactions, SCENE_INTERACTIONS_MAX)},
    {"estimator", "how paths to the source are found: all hits connected to it, or by chance",
     WORD(STRUCTURE, estimator) = {[SONJECT_ESTIMATOR_CONNECT] = "connect",
                                   [SONJECT_ESTIMATOR_BRUTE_FORCE] = "brute_force"}},
    {"order_energies", "also keep the energy of each number of interactions", .kind = FIELD_FLAG32,
     .offset = offsetof(STRUCTURE, order_energies)},
    {"match", "what targets take over from a measured magnitude image", SAME(match_section)},
};
const struct section injection_section = {injection_fields, COUNT(injection_fields),
                                          finish_injection};
#undef STRUCTURE

/* Keys are read in this order, whatever the file's: the water needs the sonar's frequency and the
 * surface's depth. */
#define STRUCTURE struct scene
static const struct field scene_fields[] = {
    {"sonject", "version of the format, 1", .kind = FIELD_SPECIAL, .read = read_version, REQUIRED},
    {"band", "which of the bands this scene is", .kind = FIELD_SPECIAL, .read = read_band,
     .unit = "a band's name"},
    {"bands", "by name, the keys in which each of several sonars differs from the rest of the file",
     .kind = FIELD_SPECIAL, .read = read_band, .unit = "sections of the scene's keys"},
    {"input", "where the image comes from: path, uniform or synthetic, and geometry",
     SAME(input_section), REQUIRED},
    {"patch", "part of the swath that is worked on; by default all of it",
     PART(STRUCTURE, patch, patch_section)},
    {"sonar", "the sonar: frequency, bandwidth and altitude", PART(STRUCTURE, sonar, sonar_section),
     REQUIRED},
    {"seabed", "the seabed", PART(STRUCTURE, seabed, seabed_section)},
    {"surface", "the sea surface; by default none is heard",
     PART(STRUCTURE, surface, surface_section)},
    {"medium", "the water", PART(STRUCTURE, medium, medium_section), .read = read_medium},
    {"injection", "how targets are put into the image",
     PART(STRUCTURE, injection, injection_section)},
    {"elements", "the array whose time series `sonject elements` writes",
     PART(STRUCTURE, elements, elements_section)},
    {"objects", "list of the targets", .kind = FIELD_SPECIAL, .read = read_objects,
     .section = &object_section, .is_list = true},
};
const struct section scene_section = {scene_fields, COUNT(scene_fields), finish_scene};
