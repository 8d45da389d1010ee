/* sonject quicklook: a picture of an image, with axes in metres. */
#include <sonject/sonject.h>

#include "console.h"
#include "image_arguments.h"
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
    {"--channel", NULL, "port|starboard|N", "channel of an XTF or JSF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "array of an HDF5 or MATLAB file that has several", ARGUMENT_TEXT,
     false, MEMBER(array)},
};

static int work(const void *verb_options)
{
    const struct quicklook_options *options = verb_options;
    sonject_quicklook_params params = {.struct_size = sizeof(params)};
    char geometry[IMAGE_TEXT], transfer[IMAGE_TEXT];
    params.image = options->image;
    params.picture = options->picture;
    params.channel = options->channel;
    params.array = options->array;
    if (!decibels_parse("quicklook", options->decibels, &params.minimum_db, &params.maximum_db) ||
        !transfer_parse("quicklook", options->transfer, transfer, &params.transfer) ||
        !channel_check("quicklook", options->channel) ||
        !geometry_parse("quicklook", &options->geometry, &params.range_axis, &params.altitude_m,
                        geometry, &params.geometry))
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
