/* sonject convert: a file of one format from a file of another. */
#include <string.h>

#include <sonject/sonject.h>

#include "channel_argument.h"
#include "exit_code.h"
#include "message.h"
#include "verbs.h"

struct convert_options {
    const char *input;
    const char *output;
    const char *into;
    const char *channel;
    const char *array;
    bool magnitude;
    const char *type;
    struct number_argument scale;
    const char *range_axis;
    struct number_argument altitude;
    struct number_argument row_spacing;
    struct number_argument column_spacing;
    struct number_argument first_range;
};

#define MEMBER(name) offsetof(struct convert_options, name)

static const struct argument arguments[] = {
    {"--into", NULL, "FILE", "make OUT a copy of FILE with IN's samples", ARGUMENT_TEXT, false,
     MEMBER(into)},
    {"--channel", NULL, "port|starboard|N", "of an XTF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "in an HDF5 or MATLAB file of several", ARGUMENT_TEXT, false,
     MEMBER(array)},
    {"--magnitude", NULL, NULL, "of complex samples", ARGUMENT_FLAG, false, MEMBER(magnitude)},
    {"--type", NULL, "TYPE", "uint8, uint16 or float32, with --scale", ARGUMENT_TEXT, false,
     MEMBER(type)},
    {"--scale", NULL, "FACTOR", "new samples over old ones, with --type", ARGUMENT_NUMBER, false,
     MEMBER(scale)},
    {"--range-axis", NULL, "slant|ground", "resample the columns to equal steps of it",
     ARGUMENT_TEXT, false, MEMBER(range_axis)},
    {"--altitude", NULL, "M", "height of the sonar over the seabed", ARGUMENT_NUMBER, false,
     MEMBER(altitude)},
    {"--row-spacing", NULL, "M", "along-track distance of rows", ARGUMENT_NUMBER, false,
     MEMBER(row_spacing)},
    {"--column-spacing", NULL, "M", "slant range distance of columns", ARGUMENT_NUMBER, false,
     MEMBER(column_spacing)},
    {"--first-range", NULL, "M", "slant range of the first column", ARGUMENT_NUMBER, false,
     MEMBER(first_range)},
};

static bool read_type(const struct convert_options *options, sonject_convert_params *params)
{
    static const char *const types[] = {"uint8", "uint16", "float32"};
    if ((options->type != NULL) != options->scale.is_given) {
        message("convert: --type and --scale belong together");
        return false;
    }
    if (!options->type)
        return true;
    params->scale = options->scale.value;
    for (uint32_t i = 0; i < 3; i++)
        if (strcmp(options->type, types[i]) == 0)
            params->samples = SONJECT_SAMPLES_UINT8 + i;
    if (params->samples == SONJECT_SAMPLES_KEPT || !(params->scale > 0.0)) {
        message("convert: --type takes uint8, uint16 or float32, and --scale a number above 0");
        return false;
    }
    return true;
}

static bool read_range_axis(const char *text, sonject_convert_params *params)
{
    if (strcmp(text, "slant") == 0) {
        params->range_axis = SONJECT_CONVERT_AXIS_SLANT;
    } else if (strcmp(text, "ground") == 0) {
        params->range_axis = SONJECT_CONVERT_AXIS_GROUND;
    } else {
        message("convert: --range-axis takes slant or ground, not \"", text, "\"");
        return false;
    }
    return true;
}

static bool read_geometry(const struct convert_options *options, sonject_convert_params *params)
{
    const int given = options->row_spacing.is_given + options->column_spacing.is_given +
                      options->first_range.is_given;
    if (options->altitude.is_given && !(options->altitude.value > 0)) {
        message("convert: --altitude must be above 0");
        return false;
    }
    params->altitude_m = options->altitude.is_given ? options->altitude.value : 0.0;
    if (given == 0)
        return true;
    if (given < 3) {
        message("convert: --row-spacing, --column-spacing and --first-range belong together");
        return false;
    }
    params->has_geometry = 1;
    params->geometry.row_spacing_m = options->row_spacing.value;
    params->geometry.column_spacing_m = options->column_spacing.value;
    params->geometry.first_slant_range_m = options->first_range.value;
    return true;
}

static bool fill(const struct convert_options *options, sonject_convert_params *params)
{
    sonject_convert_params_init(params);
    params->input = options->input;
    params->output = options->output;
    params->into = options->into;
    params->array = options->array;
    params->magnitude = options->magnitude;
    return (!options->channel || channel_parse("convert", options->channel, &params->channel)) &&
           read_type(options, params) &&
           (!options->range_axis || read_range_axis(options->range_axis, params)) &&
           read_geometry(options, params);
}

static void tell(void *user, const char *line)
{
    (void)user;
    message(line);
}

static int work(const void *verb_options)
{
    sonject_convert_params params;
    if (!fill(verb_options, &params))
        return EXIT_CODE_USAGE;
    sonject_context_params context_params;
    sonject_context_params_init(&context_params);
    context_params.log = tell;
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(&context_params, &context);
    if (status == SONJECT_OK)
        status = sonject_convert(context, &params);
    int code = status == SONJECT_OK ? EXIT_CODE_DONE : fail_with(context, status);
    sonject_context_release(&context);
    return code;
}

const struct verb convert_verb = {
    .name = "convert",
    .summary = "makes a file of one format from a file of another, without loss",
    .operand = "IN",
    .operand_offset = MEMBER(input),
    .second_operand = "OUT",
    .second_offset = MEMBER(output),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "OUT is .tif, .png, .npy, .h5, .pgm or .pfm; with --into FILE it is of FILE's format,\n"
        "XTF and MATLAB too. Samples that a new type cannot hold are refused, never cut.",
    .options_size = sizeof(struct convert_options),
    .work = work,
};
