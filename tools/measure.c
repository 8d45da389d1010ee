/* sonject measure: an image's statistics, or its contacts, as JSON. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/sonject.h>

#include "console.h"
#include "image_arguments.h"
#include "verbs.h"

struct measure_options {
    const char *image;
    const char *labels;
    const char *transfer;
    const char *channel;
    const char *array;
    struct text_list boxes;
    bool range_to_left;
    const char *truth;
    struct number_argument row_spacing, column_spacing;
};

#define MEMBER(name) offsetof(struct measure_options, name)

static const struct argument arguments[] = {
    {"--targets", NULL, "MASK", "mask of what is not seabed, such as a run's labels.png",
     ARGUMENT_TEXT, false, MEMBER(labels)},
    {"--transfer", NULL, "KIND[:P[:OFFSET]]", "how stored numbers came from amplitudes, see below",
     ARGUMENT_TEXT, false, MEMBER(transfer)},
    {"--channel", NULL, "port|starboard|N", "channel of an XTF or JSF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "array of an HDF5 or MATLAB file that has several", ARGUMENT_TEXT,
     false, MEMBER(array)},
    {"--box", NULL, "ROW,COLUMN,ROWS,COLUMNS", "measures the contact in this box; may be repeated",
     ARGUMENT_TEXTS, false, MEMBER(boxes)},
    {"--truth", NULL, "FILE", "measures the contacts of a run's truth.json", ARGUMENT_TEXT, false,
     MEMBER(truth)},
    {"--range-to-left", NULL, NULL,
     "range grows to the left, as in the port half of an image of two sides; --truth knows it",
     ARGUMENT_FLAG, false, MEMBER(range_to_left)},
    {"--row-spacing", NULL, "M",
     "distance between rows, for lengths in metres; by default from truth or file", ARGUMENT_NUMBER,
     false, MEMBER(row_spacing)},
    {"--column-spacing", NULL, "M",
     "distance between columns, in slant range; by default from truth or file", ARGUMENT_NUMBER,
     false, MEMBER(column_spacing)},
};

/* Prints a number; null for NaN and infinity, which JSON lacks. */
static void print_number(const char *name, double value, const char *end)
{
    if (isfinite(value))
        printf("    \"%s\": %.6g%s\n", name, value, end);
    else
        printf("    \"%s\": null%s\n", name, end);
}

static int print_measurement(const sonject_measurement *measurement)
{
    printf("{\n  \"seabed\": {\n");
    print_number("amplitude_contrast", measurement->amplitude_contrast, ",");
    print_number("intensity_contrast", measurement->intensity_contrast, ",");
    print_number("looks", measurement->looks, ",");
    print_number("k_shape", measurement->shape, ",");
    print_number("row_correlation", measurement->row_correlation, ",");
    print_number("column_correlation", measurement->column_correlation, ",");
    print_number("row_length_pixels", measurement->row_length_pixels, ",");
    print_number("column_length_pixels", measurement->column_length_pixels, "");
    printf("  }\n}\n");
    return finish_output();
}

/* Fills in the options about the image. text: room for its transfer. */
static bool fill(const struct measure_options *options, sonject_measure_params *params,
                 char text[IMAGE_TEXT])
{
    memset(params, 0, sizeof(*params));
    params->struct_size = sizeof(*params);
    params->image = options->image;
    params->labels = options->labels;
    params->channel = options->channel;
    params->array = options->array;
    return channel_check("measure", options->channel) &&
           transfer_parse("measure", options->transfer, text, &params->transfer);
}

static bool wants_contacts(const struct measure_options *options)
{
    return options->boxes.count > 0 || options->truth;
}

/* Parses "ROW,COLUMN,ROWS,COLUMNS". */
static bool box_parse(const char *text, sonject_box *box)
{
    uint64_t values[4];
    const char *rest = text;
    for (int i = 0; i < 4; i++) {
        char *end;
        if (*rest < '0' || *rest > '9')
            return false;
        errno = 0;
        values[i] = strtoull(rest, &end, 10);
        if (errno || *end != (i < 3 ? ',' : '\0'))
            return false;
        rest = end + 1;
    }
    box->first_row = values[0];
    box->first_column = values[1];
    box->rows = values[2];
    box->columns = values[3];
    return box->rows > 0 && box->columns > 0;
}

/* Fills in the options about contacts. boxes: room for as many as there are --box options. */
static bool fill_contacts(const struct measure_options *options, sonject_measure_params *params,
                          sonject_box *boxes)
{
    for (size_t i = 0; i < options->boxes.count; i++)
        if (!box_parse(options->boxes.texts[i], &boxes[i])) {
            message("measure: --box takes ROW,COLUMN,ROWS,COLUMNS in pixels, not \"",
                    options->boxes.texts[i], "\"");
            return false;
        }
    params->truth = options->truth;
    params->boxes = boxes;
    params->box_count = (uint32_t)options->boxes.count;
    params->range_to_left = options->range_to_left;
    params->row_spacing_m = options->row_spacing.value;
    params->column_spacing_m = options->column_spacing.value;
    return true;
}

/* Measures contacts and prints them as JSON. */
static int work_on_contacts(const struct measure_options *options, sonject_measure_params *params)
{
    sonject_box *boxes = calloc(options->boxes.count + 1, sizeof *boxes);
    sonject_context *context = NULL;
    char *text = NULL;
    int code = EXIT_CODE_USAGE;
    if (!boxes) {
        message("measure: out of memory");
        code = EXIT_CODE_STORAGE;
    } else if (fill_contacts(options, params, boxes)) {
        sonject_status status = sonject_context_create(NULL, &context);
        if (status == SONJECT_OK)
            status = sonject_measure_contacts(context, params, &text);
        if (text)
            puts(text);
        code = status == SONJECT_OK ? finish_output() : fail_with(context, status);
    }
    sonject_text_release(&text);
    sonject_context_release(&context);
    free(boxes);
    return code;
}

/* Returns a message about options that are wrong or exclude each other; NULL if none are. */
static const char *conflict(const struct measure_options *options)
{
    const bool has_spacing = options->row_spacing.is_given || options->column_spacing.is_given;
    if (has_spacing && !wants_contacts(options))
        return "measure: --row-spacing and --column-spacing are for --box and --truth";
    if (options->range_to_left && !wants_contacts(options))
        return "measure: --range-to-left is for --box and --truth";
    if (options->labels && wants_contacts(options))
        return "measure: --targets is for the seabed's statistics, not for contacts";
    if ((options->row_spacing.is_given && !(options->row_spacing.value > 0.0)) ||
        (options->column_spacing.is_given && !(options->column_spacing.value > 0.0)))
        return "measure: --row-spacing and --column-spacing must be above 0";
    return NULL;
}

static int work(const void *verb_options)
{
    const struct measure_options *options = verb_options;
    const char *wrong = conflict(options);
    if (wrong) {
        message(wrong);
        return EXIT_CODE_USAGE;
    }
    sonject_measure_params params;
    sonject_measurement measurement = {.struct_size = sizeof(measurement)};
    char transfer[IMAGE_TEXT];
    if (!fill(options, &params, transfer))
        return EXIT_CODE_USAGE;
    if (wants_contacts(options))
        return work_on_contacts(options, &params);
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = sonject_measure(context, &params, &measurement);
    int code = status == SONJECT_OK ? print_measurement(&measurement) : fail_with(context, status);
    sonject_context_release(&context);
    return code;
}

const struct verb measure_verb = {
    .name = "measure",
    .summary = "prints an image's statistics, or its contacts' lengths and levels, as JSON",
    .operand = "IMAGE",
    .operand_offset = MEMBER(image),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "Lengths have standard errors due to speckle. \"gap\" is the lit part between\n"
             "highlight and shadow, such as a thick target's top; \"dim\" is the first part of the "
             "shadow, if\n"
             "brighter than the rest; \"cut\" says that the box or the image ends "
             "there.\n" TRANSFER_NOTES,
    .options_size = sizeof(struct measure_options),
    .work = work,
};
