/* sonject convert: converts a file of one format to another. */
#include <sonject/sonject.h>

#include "console.h"
#include "image_arguments.h"
#include "verbs.h"

struct convert_options {
    const char *input;
    const char *output;
    const char *into;
    const char *channel;
    const char *array;
    const char *decibels;
    struct geometry_arguments geometry;
};

#define MEMBER(name) offsetof(struct convert_options, name)

static const struct argument arguments[] = {
    {"--into", NULL, "FILE", "make OUT a copy of FILE with IN's samples", ARGUMENT_TEXT, false,
     MEMBER(into)},
    {"--db", NULL, "MIN:MAX",
     "write 8 bit grey levels, black at MIN and white at MAX, dB over full scale", ARGUMENT_TEXT,
     false, MEMBER(decibels)},
    {"--channel", NULL, "port|starboard|N", "channel of an XTF or JSF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "array of an HDF5 or MATLAB file that has several", ARGUMENT_TEXT,
     false, MEMBER(array)},
    GEOMETRY_ARGUMENTS(struct convert_options, "resample the columns to equal steps of this range"),
};

static int work(const void *verb_options)
{
    const struct convert_options *options = verb_options;
    sonject_convert_params params = {.struct_size = sizeof(params)};
    char geometry[IMAGE_TEXT];
    uint32_t is_ground = 0;
    params.input = options->input;
    params.output = options->output;
    params.into = options->into;
    params.channel = options->channel;
    params.array = options->array;
    if (!decibels_parse("convert", options->decibels, &params.black_db, &params.white_db) ||
        !channel_check("convert", options->channel) ||
        !geometry_parse("convert", &options->geometry, &is_ground, &params.altitude_m, geometry,
                        &params.geometry))
        return EXIT_CODE_USAGE;
    if (options->geometry.range_axis)
        params.range_axis = is_ground ? SONJECT_CONVERT_AXIS_GROUND : SONJECT_CONVERT_AXIS_SLANT;
    sonject_context_params context_params = {.struct_size = sizeof(context_params)};
    context_params.log = progress_log;
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
    .summary = "converts an image or recording to another file format",
    .operand = "IN",
    .operand_offset = MEMBER(input),
    .second_operand = "OUT",
    .second_offset = MEMBER(output),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "With --range-axis slant, an image that does not state its axis is taken to be in ground\n"
        "range, and so is --first-range. Without --db no sample changes. OUT is .tif, .png, .npy\n"
        "or .h5. It keeps the geometry that is known, but not IN's tags and further pages. With\n"
        "--into FILE it has FILE's format, which may also be XTF, JSF or MATLAB, and all else in\n"
        "FILE. Samples that a file cannot hold are refused, never clipped; only in recordings\n"
        "that scale each ping (JSF, some XTF), numbers beyond a ping's samples become the largest.",
    .options_size = sizeof(struct convert_options),
    .work = work,
};
