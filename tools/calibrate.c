/* sonject calibrate: estimates the properties of a swath for scenes. */
#include <stdio.h>

#include <sonject/sonject.h>

#include "console.h"
#include "image_arguments.h"
#include "verbs.h"

struct calibrate_options {
    const char *image;
    const char *output;
    const char *picture;
    bool json;
    const char *channel;
    const char *array;
    struct geometry_arguments geometry;
};

#define MEMBER(name) offsetof(struct calibrate_options, name)

static const struct argument arguments[] = {
    {"--output", "-o", "FILE", "write the result to this file instead of standard output",
     ARGUMENT_TEXT, false, MEMBER(output)},
    {"--picture", NULL, "PNG", "draw the measurements, to judge the result by", ARGUMENT_TEXT,
     false, MEMBER(picture)},
    {"--json", NULL, NULL, "write JSON, which scenes take as well", ARGUMENT_FLAG, false,
     MEMBER(json)},
    {"--channel", NULL, "port|starboard|N", "channel of an XTF or JSF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "array of an HDF5 or MATLAB file that has several", ARGUMENT_TEXT,
     false, MEMBER(array)},
    GEOMETRY_NUMBER(struct calibrate_options, "--row-spacing", "M",
                    "distance between rows, along the track", row_spacing),
    GEOMETRY_NUMBER(struct calibrate_options, "--column-spacing", "M",
                    "distance between columns, in slant range", column_spacing),
    GEOMETRY_NUMBER(struct calibrate_options, "--first-range", "M",
                    "slant range of the first column", first_range),
};

static int work(const void *verb_options)
{
    const struct calibrate_options *options = verb_options;
    sonject_calibrate_params params = {.struct_size = sizeof(params)};
    char geometry[IMAGE_TEXT];
    uint32_t is_ground = 0;
    double altitude_m = 0.0;
    params.image = options->image;
    params.as_json = options->json;
    params.channel = options->channel;
    params.array = options->array;
    params.picture = options->picture;
    params.output = options->output;
    if (!channel_check("calibrate", options->channel) ||
        !geometry_parse("calibrate", &options->geometry, &is_ground, &altitude_m, geometry,
                        &params.geometry))
        return EXIT_CODE_USAGE;
    sonject_context *context = NULL;
    char *text = NULL;
    const sonject_context_params context_params = {.struct_size = sizeof(context_params),
                                                   .log = progress_note};
    sonject_status status = sonject_context_create(&context_params, &context);
    if (status == SONJECT_OK)
        status = sonject_calibrate(context, &params, &text);
    if (text && !options->output)
        fputs(text, stdout);
    const int code = status == SONJECT_OK ? finish_output() : fail_with(context, status);
    sonject_text_release(&text);
    sonject_context_release(&context);
    return code;
}

const struct verb calibrate_verb = {
    .name = "calibrate",
    .summary = "estimates a swath's curve, ceiling, speckle, noise floor and altitude, for scenes",
    .operand = "SWATH",
    .operand_offset = MEMBER(image),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "A scene names the file as input.calibration; the scene's own keys take precedence. Each\n"
        "estimate has a standard error and its method, or the reason why there is none.",
    .options_size = sizeof(struct calibrate_options),
    .work = work,
};
