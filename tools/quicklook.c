/* sonject quicklook: a picture of an image, with axes in metres. */
#include <stdio.h>
#include <string.h>

#include <sonject/sonject.h>

#include "channel_argument.h"
#include "exit_code.h"
#include "geometry_argument.h"
#include "message.h"
#include "number.h"
#include "transfer_argument.h"
#include "verbs.h"

struct quicklook_options {
    const char *image;
    const char *picture;
    const char *decibels;
    const char *transfer;
    const char *channel;
    const char *array;
    struct geometry_arguments geometry;
};

#define MEMBER(name) offsetof(struct quicklook_options, name)

static const struct argument arguments[] = {
    {"--output", "-o", "PNG", "picture to write", ARGUMENT_TEXT, true, MEMBER(picture)},
    {"--db", NULL, "MIN:MAX", "ends of the grey scale; otherwise chosen from the image",
     ARGUMENT_TEXT, false, MEMBER(decibels)},
    GEOMETRY_ARGUMENTS(struct quicklook_options, "horizontal axis; ground needs the altitude"),
    {"--transfer", NULL, "KIND[:P[:OFFSET]]", "how stored numbers came from amplitudes, see below",
     ARGUMENT_TEXT, false, MEMBER(transfer)},
    {"--channel", NULL, "port|starboard|N", "of an XTF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "in an HDF5 or MATLAB file of several", ARGUMENT_TEXT, false,
     MEMBER(array)},
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

static bool read_transfer(const char *text, sonject_quicklook_params *params)
{
    params->has_transfer = 1;
    return transfer_parse("quicklook", text, &params->transfer);
}

static bool fill(const struct quicklook_options *options, sonject_quicklook_params *params)
{
    sonject_quicklook_params_init(params);
    params->image = options->image;
    params->picture = options->picture;
    params->array = options->array;
    return (!options->decibels || read_decibels(options->decibels, params)) &&
           (!options->transfer || read_transfer(options->transfer, params)) &&
           (!options->channel || channel_parse("quicklook", options->channel, &params->channel)) &&
           geometry_parse("quicklook", &options->geometry, &params->range_axis, &params->altitude_m,
                          &params->has_geometry, &params->geometry);
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
