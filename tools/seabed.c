/* sonject seabed: a synthetic seabed image with its metadata. */
#include <stdio.h>
#include <string.h>

#include <sonject/sonject.h>

#include "console.h"
#include "verbs.h"

struct seabed_options {
    const char *image;
    struct whole_argument rows;
    struct whole_argument columns;
    struct whole_argument seed;
    struct number_argument row_spacing;
    struct number_argument column_spacing;
    struct number_argument first_range;
    struct number_argument altitude;
    struct number_argument frequency;
    struct number_argument bandwidth;
    const char *speckle_shape;
    struct number_argument texture_length;
    struct number_argument ripple_wavelength;
    struct number_argument ripple_contrast;
    struct number_argument ripple_heading;
    struct number_argument patch_contrast;
    struct number_argument patch_length;
    struct number_argument mean_amplitude;
    bool is_complex;
};

#define MEMBER(name)             offsetof(struct seabed_options, name)
#define NUMBER(name, unit, help) name, NULL, unit, help, ARGUMENT_NUMBER, false

static const struct argument arguments[] = {
    {"--output", "-o", "IMAGE", "file to write: .tif (float32) or .png (8 bit)", ARGUMENT_TEXT,
     true, MEMBER(image)},
    {"--rows", NULL, "N", "number of pings", ARGUMENT_WHOLE, false, MEMBER(rows)},
    {"--columns", NULL, "N", "number of range samples", ARGUMENT_WHOLE, false, MEMBER(columns)},
    {"--seed", NULL, "N", "seed of the random numbers", ARGUMENT_WHOLE, false, MEMBER(seed)},
    {NUMBER("--row-spacing", "M", "along-track distance of rows"), MEMBER(row_spacing)},
    {NUMBER("--column-spacing", "M", "slant range distance of columns"), MEMBER(column_spacing)},
    {NUMBER("--first-range", "M", "slant range of the first column"), MEMBER(first_range)},
    {NUMBER("--altitude", "M", "height of the sonar over the seabed"), MEMBER(altitude)},
    {NUMBER("--frequency", "HZ", "centre frequency"), MEMBER(frequency)},
    {NUMBER("--bandwidth", "HZ", "bandwidth, which sets the range resolution"), MEMBER(bandwidth)},
    {"--speckle-shape", NULL, "NU", "shape of the K distribution, inf: Rayleigh", ARGUMENT_TEXT,
     false, MEMBER(speckle_shape)},
    {NUMBER("--texture-length", "M", "correlation length of its texture"), MEMBER(texture_length)},
    {NUMBER("--ripple-wavelength", "M", "distance of sand ripples"), MEMBER(ripple_wavelength)},
    {NUMBER("--ripple-contrast", "0...1", "depth of the ripples' modulation, 0: no ripples"),
     MEMBER(ripple_contrast)},
    {NUMBER("--ripple-heading", "DEG", "direction across the crests, from track towards range"),
     MEMBER(ripple_heading)},
    {NUMBER("--patch-contrast", "DB", "level step between sediments, 0: one sediment"),
     MEMBER(patch_contrast)},
    {NUMBER("--patch-length", "M", "typical size of a sediment patch"), MEMBER(patch_length)},
    {NUMBER("--mean-amplitude", "A", "rms amplitude of the darker sediment, 1: full scale"),
     MEMBER(mean_amplitude)},
    {"--complex", NULL, NULL, "complex pixels instead of amplitudes (.tif)", ARGUMENT_FLAG, false,
     MEMBER(is_complex)},
};

/* Keys of a scene whose input is the seabed, and the options that set them. */
static const struct {
    const char *key;
    size_t option; /* a struct number_argument */
    double factor; /* of the key's unit */
    const char *unit;
} number_keys[] = {
    {"input.geometry.row_spacing", MEMBER(row_spacing), 1.0, ""},
    {"input.geometry.column_spacing", MEMBER(column_spacing), 1.0, ""},
    {"input.geometry.first_slant_range", MEMBER(first_range), 1.0, ""},
    {"sonar.altitude", MEMBER(altitude), 1.0, ""},
    {"sonar.frequency", MEMBER(frequency), 1.0, ""},
    {"sonar.bandwidth", MEMBER(bandwidth), 1.0, ""},
    {"input.synthetic.texture_length", MEMBER(texture_length), 1.0, ""},
    {"input.synthetic.ripple_wavelength", MEMBER(ripple_wavelength), 1.0, ""},
    {"input.synthetic.ripple_contrast", MEMBER(ripple_contrast), 1.0, ""},
    {"input.synthetic.ripple_heading", MEMBER(ripple_heading), 3.14159265358979323846 / 180,
     " rad"},
    {"input.synthetic.patch_contrast", MEMBER(patch_contrast), 1.0, ""},
    {"input.synthetic.patch_length", MEMBER(patch_length), 1.0, ""},
    {"input.synthetic.mean_amplitude", MEMBER(mean_amplitude), 1.0, ""},
};

static sonject_status set_whole(sonject_scene *scene, const char *key,
                                const struct whole_argument *number)
{
    char text[32];
    snprintf(text, sizeof(text), "%llu", (unsigned long long)number->value);
    return number->is_given ? sonject_scene_set(scene, key, text) : SONJECT_OK;
}

static sonject_status set_keys(sonject_scene *scene, const struct seabed_options *options)
{
    char text[48];
    sonject_status status = set_whole(scene, "input.synthetic.rows", &options->rows);
    if (status == SONJECT_OK)
        status = set_whole(scene, "input.synthetic.columns", &options->columns);
    if (status == SONJECT_OK)
        status = set_whole(scene, "input.synthetic.seed", &options->seed);
    if (status == SONJECT_OK && options->speckle_shape)
        status = sonject_scene_set(scene, "input.synthetic.speckle_shape", options->speckle_shape);
    if (status == SONJECT_OK && options->is_complex)
        status = sonject_scene_set(scene, "input.synthetic.complex", "true");
    for (size_t i = 0; status == SONJECT_OK && i < sizeof(number_keys) / sizeof(number_keys[0]);
         i++) {
        struct number_argument number;
        memcpy(&number, (const char *)options + number_keys[i].option, sizeof(number));
        if (!number.is_given)
            continue;
        snprintf(text, sizeof(text), "%.17g%s", number.value * number_keys[i].factor,
                 number_keys[i].unit);
        status = sonject_scene_set(scene, number_keys[i].key, text);
    }
    return status;
}

static bool is_side(const char *name, const struct whole_argument *number)
{
    if (!number->is_given || (number->value > 0 && number->value <= UINT32_MAX))
        return true;
    message("seabed: ", name, " lies outside 1...2^20");
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
