/* sonject seabed: a synthetic seabed image with its metadata. */
#include <stdio.h>
#include <string.h>

#include <sonject/sonject.h>

#include "console.h"
#include "verbs.h"

/* The numbers: ROW(member, option, unit, help, key of a scene whose input is the seabed). */
#define NUMBERS(ROW)                                                                               \
    ROW(row_spacing, "--row-spacing", "M", "distance between rows, along the track",               \
        "input.geometry.row_spacing")                                                              \
    ROW(column_spacing, "--column-spacing", "M", "distance between columns, in slant range",       \
        "input.geometry.column_spacing")                                                           \
    ROW(first_range, "--first-range", "M", "slant range of the first column",                      \
        "input.geometry.first_slant_range")                                                        \
    ROW(altitude, "--altitude", "M", "height of the sonar over the seabed", "sonar.altitude")      \
    ROW(frequency, "--frequency", "HZ", "centre frequency", "sonar.frequency")                     \
    ROW(bandwidth, "--bandwidth", "HZ", "bandwidth, which sets the range resolution",              \
        "sonar.bandwidth")                                                                         \
    ROW(texture_length, "--texture-length", "M",                                                   \
        "correlation length of the K distribution's texture", "input.synthetic.texture_length")    \
    ROW(ripple_wavelength, "--ripple-wavelength", "M",                                             \
        "wavelength of sand ripples, from crest to crest", "input.synthetic.ripple_wavelength")    \
    ROW(ripple_contrast, "--ripple-contrast", "0...1",                                             \
        "depth of the ripples' modulation, 0: no ripples", "input.synthetic.ripple_contrast")      \
    ROW(ripple_heading, "--ripple-heading", "DEG",                                                 \
        "direction across the crests, from track towards range", "input.synthetic.ripple_heading") \
    ROW(patch_contrast, "--patch-contrast", "DB", "level step between sediments, 0: one sediment", \
        "input.synthetic.patch_contrast")                                                          \
    ROW(patch_length, "--patch-length", "M", "typical size of a sediment patch",                   \
        "input.synthetic.patch_length")                                                            \
    ROW(mean_amplitude, "--mean-amplitude", "A",                                                   \
        "rms amplitude of the darker sediment, 1: full scale", "input.synthetic.mean_amplitude")

struct seabed_options {
    const char *image;
    struct whole_argument rows, columns, seed;
#define NUMBER_MEMBER(member, option, unit, help, key) struct number_argument member;
    NUMBERS(NUMBER_MEMBER)
    const char *speckle_shape;
    bool is_complex;
};

#define MEMBER(name) offsetof(struct seabed_options, name)

static const struct argument arguments[] = {
    {"--output", "-o", "IMAGE", "file to write: .tif (float32) or .png (8 bit)", ARGUMENT_TEXT,
     true, MEMBER(image)},
    {"--rows", NULL, "N", "number of pings", ARGUMENT_WHOLE, false, MEMBER(rows)},
    {"--columns", NULL, "N", "number of range samples", ARGUMENT_WHOLE, false, MEMBER(columns)},
    {"--seed", NULL, "N", "seed of the random numbers", ARGUMENT_WHOLE, false, MEMBER(seed)},
    {"--speckle-shape", NULL, "NU", "shape of the K distribution, inf: Rayleigh", ARGUMENT_TEXT,
     false, MEMBER(speckle_shape)},
    {"--complex", NULL, NULL, "complex pixels instead of amplitudes (.tif)", ARGUMENT_FLAG, false,
     MEMBER(is_complex)},
#define NUMBER_ARGUMENT(member, option, unit, help, key)                                           \
    {option, NULL, unit, help, ARGUMENT_NUMBER, false, MEMBER(member)},
    NUMBERS(NUMBER_ARGUMENT)};

static sonject_status set_number(sonject_scene *scene, const char *key, const char *unit,
                                 const struct number_argument *number)
{
    char text[48];
    snprintf(text, sizeof(text), "%.17g%s", number->value, strcmp(unit, "DEG") == 0 ? " rad" : "");
    return number->is_given ? sonject_scene_set(scene, key, text) : SONJECT_OK;
}

static sonject_status set_whole(sonject_scene *scene, const char *key,
                                const struct whole_argument *number)
{
    char text[32];
    snprintf(text, sizeof(text), "%llu", (unsigned long long)number->value);
    return number->is_given ? sonject_scene_set(scene, key, text) : SONJECT_OK;
}

static sonject_status set_keys(sonject_scene *scene, const struct seabed_options *options)
{
    sonject_status status = set_whole(scene, "input.synthetic.rows", &options->rows);
    if (status == SONJECT_OK)
        status = set_whole(scene, "input.synthetic.columns", &options->columns);
    if (status == SONJECT_OK)
        status = set_whole(scene, "input.synthetic.seed", &options->seed);
    if (status == SONJECT_OK && options->speckle_shape)
        status = sonject_scene_set(scene, "input.synthetic.speckle_shape", options->speckle_shape);
    if (status == SONJECT_OK && options->is_complex)
        status = sonject_scene_set(scene, "input.synthetic.complex", "true");
#define SET_NUMBER(member, option, unit, help, key)                                                \
    if (status == SONJECT_OK)                                                                      \
        status = set_number(scene, key, unit, &options->member);
    NUMBERS(SET_NUMBER)
    return status;
}

static bool is_side(const char *name, const struct whole_argument *number)
{
    if (!number->is_given || (number->value > 0 && number->value <= UINT32_MAX))
        return true;
    message("seabed: ", name, " must be 1...2^20");
    return false;
}

static bool is_shape(const char *text)
{
    double shape;
    if (!text || strcmp(text, "inf") == 0 || number_parse(text, &shape))
        return true;
    message("seabed: --speckle-shape takes a number above 0 or inf, not \"", text, "\"");
    return false;
}

static int work(const void *verb_options)
{
    const struct seabed_options *options = verb_options;
    const sonject_scene_read_params params = {
        .struct_size = sizeof(params),
        .text = "sonject: 1\n"
                "input: {synthetic: {rows: 400, columns: 400}, geometry: {row_spacing: 0.025,\n"
                "  column_spacing: 0.025, first_slant_range: 44}}\n"
                "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"};
    if (!is_side("--rows", &options->rows) || !is_side("--columns", &options->columns) ||
        !is_shape(options->speckle_shape))
        return EXIT_CODE_USAGE;
    sonject_context *context = NULL;
    sonject_scene *scene = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = sonject_scene_read(context, NULL, &params, &scene);
    if (status == SONJECT_OK)
        status = set_keys(scene, options);
    if (status == SONJECT_OK)
        status = sonject_seabed_write(context, scene, options->image);
    int code = status == SONJECT_OK ? EXIT_CODE_DONE : fail_with(context, status);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    return code;
}

const struct verb seabed_verb = {
    .name = "seabed",
    .summary = "writes a synthetic seabed image with its metadata",
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "",
    .options_size = sizeof(struct seabed_options),
    .work = work,
};
