/* sonject seabed: a synthetic seabed image with its metadata. */
#include <math.h>
#include <string.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "message.h"
#include "number.h"
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

static void assign(const struct number_argument *number, double *target)
{
    if (number->is_given)
        *target = number->value;
}

static bool assign_whole(const char *name, const struct whole_argument *number, uint32_t *target)
{
    if (!number->is_given)
        return true;
    if (number->value == 0 || number->value > UINT32_MAX) {
        message("seabed: ", name, " lies outside 1...2^20");
        return false;
    }
    *target = (uint32_t)number->value;
    return true;
}

static bool read_speckle_shape(const char *text, double *shape)
{
    if (!text || number_parse(text, shape))
        return true;
    if (strcmp(text, "inf") == 0) {
        *shape = (double)INFINITY;
        return true;
    }
    message("seabed: --speckle-shape takes a number above 0 or inf, not \"", text, "\"");
    return false;
}

static bool fill_synthetic(const struct seabed_options *options,
                           sonject_synthetic_params *synthetic)
{
    static const double radians_per_degree = 3.14159265358979323846 / 180;
    synthetic->complex_pixels = options->is_complex;
    if (options->seed.is_given)
        synthetic->seed = options->seed.value;
    assign(&options->texture_length, &synthetic->texture_length_m);
    assign(&options->ripple_wavelength, &synthetic->ripple_wavelength_m);
    assign(&options->ripple_contrast, &synthetic->ripple_contrast);
    assign(&options->patch_contrast, &synthetic->patch_contrast_db);
    assign(&options->patch_length, &synthetic->patch_length_m);
    assign(&options->mean_amplitude, &synthetic->mean_amplitude);
    if (options->ripple_heading.is_given)
        synthetic->ripple_heading_rad = options->ripple_heading.value * radians_per_degree;
    return assign_whole("--rows", &options->rows, &synthetic->rows) &&
           assign_whole("--columns", &options->columns, &synthetic->columns) &&
           read_speckle_shape(options->speckle_shape, &synthetic->speckle_shape);
}

static bool fill(const struct seabed_options *options, sonject_seabed_file_params *params)
{
    sonject_seabed_file_params_init(params);
    params->image = options->image;
    assign(&options->row_spacing, &params->geometry.row_spacing_m);
    assign(&options->column_spacing, &params->geometry.column_spacing_m);
    assign(&options->first_range, &params->geometry.first_slant_range_m);
    assign(&options->altitude, &params->sonar.altitude_m);
    assign(&options->frequency, &params->sonar.centre_frequency_hz);
    assign(&options->bandwidth, &params->sonar.bandwidth_hz);
    return fill_synthetic(options, &params->synthetic);
}

static int work(const void *verb_options)
{
    sonject_seabed_file_params params;
    if (!fill(verb_options, &params))
        return EXIT_CODE_USAGE;
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = sonject_seabed_write(context, &params);
    int code = status == SONJECT_OK ? EXIT_CODE_DONE : fail_with(context, status);
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
