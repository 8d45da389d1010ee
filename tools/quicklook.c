/* sonject quicklook: a picture of an image, with axes in metres. */
#include <stdio.h>
#include <string.h>

#include <sonject/sonject.h>

#include "channel_argument.h"
#include "exit_code.h"
#include "message.h"
#include "number.h"
#include "transfer_argument.h"
#include "verbs.h"

struct quicklook_options {
    const char *image;
    const char *picture;
    const char *decibels;
    const char *range_axis;
    const char *transfer;
    const char *channel;
    struct number_argument altitude;
    struct number_argument row_spacing;
    struct number_argument column_spacing;
    struct number_argument first_range;
};

#define MEMBER(name) offsetof(struct quicklook_options, name)

static const struct argument arguments[] = {
    {"--output", "-o", "PNG", "picture to write", ARGUMENT_TEXT, true, MEMBER(picture)},
    {"--db", NULL, "MIN:MAX", "ends of the grey scale; otherwise chosen from the image",
     ARGUMENT_TEXT, false, MEMBER(decibels)},
    {"--range-axis", NULL, "slant|ground", "horizontal axis; ground needs the altitude",
     ARGUMENT_TEXT, false, MEMBER(range_axis)},
    {"--altitude", NULL, "M", "height of the sonar over the seabed", ARGUMENT_NUMBER, false,
     MEMBER(altitude)},
    {"--row-spacing", NULL, "M", "along-track distance of rows", ARGUMENT_NUMBER, false,
     MEMBER(row_spacing)},
    {"--column-spacing", NULL, "M", "slant range distance of columns", ARGUMENT_NUMBER, false,
     MEMBER(column_spacing)},
    {"--first-range", NULL, "M", "slant range of the first column", ARGUMENT_NUMBER, false,
     MEMBER(first_range)},
    {"--transfer", NULL, "KIND[:P[:OFFSET]]", "how stored numbers came from amplitudes, see below",
     ARGUMENT_TEXT, false, MEMBER(transfer)},
    {"--channel", NULL, "port|starboard|N", "of an XTF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
};

static bool read_decibels(const char *text, sonject_quicklook_params *params)
{
    char minimum[64];
    const char *maximum = next_piece(text, minimum, sizeof(minimum));
    if (maximum && number_parse(minimum, &params->minimum_db) &&
        number_parse(maximum, &params->maximum_db) && params->minimum_db < params->maximum_db)
        return true;
    message("quicklook: --db takes MIN:MAX in dB, MIN below MAX, not \"", text, "\"");
    return false;
}

static bool read_range_axis(const char *text, sonject_quicklook_params *params)
{
    if (strcmp(text, "slant") == 0) {
        params->range_axis = SONJECT_AXIS_SLANT;
    } else if (strcmp(text, "ground") == 0) {
        params->range_axis = SONJECT_AXIS_GROUND;
    } else {
        message("quicklook: --range-axis takes slant or ground, not \"", text, "\"");
        return false;
    }
    return true;
}

static bool read_transfer(const char *text, sonject_quicklook_params *params)
{
    params->has_transfer = 1;
    return transfer_parse("quicklook", text, &params->transfer);
}

static bool read_geometry(const struct quicklook_options *options, sonject_quicklook_params *params)
{
    int given = options->row_spacing.is_given + options->column_spacing.is_given +
                options->first_range.is_given;
    if (given == 0)
        return true;
    if (given < 3) {
        message("quicklook: --row-spacing, --column-spacing and --first-range belong together");
        return false;
    }
    params->has_geometry = 1;
    params->geometry.row_spacing_m = options->row_spacing.value;
    params->geometry.column_spacing_m = options->column_spacing.value;
    params->geometry.first_slant_range_m = options->first_range.value;
    return true;
}

static bool fill(const struct quicklook_options *options, sonject_quicklook_params *params)
{
    sonject_quicklook_params_init(params);
    params->image = options->image;
    params->picture = options->picture;
    if (options->altitude.is_given) {
        if (!(options->altitude.value > 0)) {
            message("quicklook: --altitude must be above 0");
            return false;
        }
        params->altitude_m = options->altitude.value;
    }
    return (!options->decibels || read_decibels(options->decibels, params)) &&
           (!options->range_axis || read_range_axis(options->range_axis, params)) &&
           (!options->transfer || read_transfer(options->transfer, params)) &&
           (!options->channel || channel_parse("quicklook", options->channel, &params->channel)) &&
           read_geometry(options, params);
}

static int work(const void *verb_options)
{
    sonject_quicklook_params params;
    if (!fill(verb_options, &params))
        return EXIT_CODE_USAGE;
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = sonject_quicklook(context, &params);
    int code = status == SONJECT_OK ? EXIT_CODE_DONE : fail_with(context, status);
    sonject_context_release(&context);
    return code;
}

const struct verb quicklook_verb = {
    .name = "quicklook",
    .summary = "draws an image with axes in metres",
    .operand = "IMAGE",
    .operand_offset = MEMBER(image),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "What is not given comes from the image's metadata.\n" TRANSFER_NOTES,
    .options_size = sizeof(struct quicklook_options),
    .work = work,
};
