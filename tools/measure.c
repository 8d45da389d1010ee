/* sonject measure: an image's statistics as JSON. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "message.h"
#include "transfer_argument.h"
#include "verbs.h"

struct measure_options {
    const char *image;
    bool wants_seam;
    const char *before;
    const char *influence;
    const char *labels;
    const char *transfer;
};

#define MEMBER(name) offsetof(struct measure_options, name)

static const struct argument arguments[] = {
    {"--seam", NULL, NULL, "how well injected background can be told from untouched", ARGUMENT_FLAG,
     false, MEMBER(wants_seam)},
    {"--before", NULL, "IMAGE", "the image before the injection", ARGUMENT_TEXT, false,
     MEMBER(before)},
    {"--influence", NULL, "MASK", "what the injection changed, such as a run's influence.png",
     ARGUMENT_TEXT, false, MEMBER(influence)},
    {"--targets", NULL, "MASK", "highlights and shadows, such as a run's labels.png", ARGUMENT_TEXT,
     false, MEMBER(labels)},
    {"--transfer", NULL, "KIND[:P[:OFFSET]]", "how stored numbers came from amplitudes, see below",
     ARGUMENT_TEXT, false, MEMBER(transfer)},
};

/* JSON knows neither NaN nor infinity. */
static void print_number(const char *name, double value, const char *end)
{
    if (isfinite(value))
        printf("    \"%s\": %.6g%s\n", name, value, end);
    else
        printf("    \"%s\": null%s\n", name, end);
}

static int print_measurement(const sonject_measurement *measurement, bool wants_seam)
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
    if (wants_seam) {
        printf("  },\n  \"seam\": {\n");
        print_number("auc", measurement->seam, ",");
        print_number("standard_error", measurement->seam_error, ",");
        print_number("auc_before", measurement->seam_before, ",");
        printf("    \"patches\": %" PRIu64 ",\n", measurement->seam_patches);
        printf("    \"background_patches\": %" PRIu64 "\n", measurement->background_patches);
    }
    printf("  }\n}\n");
    return finish_output();
}

static bool fill(const struct measure_options *options, sonject_measure_params *params)
{
    const bool has_band = options->before || options->influence;
    sonject_measure_params_init(params);
    params->image = options->image;
    params->before = options->before;
    params->influence = options->influence;
    params->labels = options->labels;
    if (options->wants_seam != has_band) {
        message(has_band ? "measure: --before and --influence are for --seam; give it too"
                         : "measure: --seam needs --before or --influence");
        return false;
    }
    params->has_transfer = options->transfer != NULL;
    return !options->transfer || transfer_parse("measure", options->transfer, &params->transfer);
}

static int work(const void *verb_options)
{
    const struct measure_options *options = verb_options;
    sonject_measure_params params;
    sonject_measurement measurement;
    if (!fill(options, &params))
        return EXIT_CODE_USAGE;
    memset(&measurement, 0, sizeof(measurement));
    measurement.struct_size = sizeof(measurement);
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = sonject_measure(context, &params, &measurement);
    int code = status == SONJECT_OK ? print_measurement(&measurement, options->wants_seam)
                                    : fail_with(context, status);
    sonject_context_release(&context);
    return code;
}

const struct verb measure_verb = {
    .name = "measure",
    .summary = "prints an image's statistics, and the seam of an injection, as JSON",
    .operand = "IMAGE",
    .operand_offset = MEMBER(image),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "The seabed is what neither mask holds. The seam is the area under the curve of a\n"
             "classifier: 0.5 is chance, 1 a seam that is always seen.\n" TRANSFER_NOTES,
    .options_size = sizeof(struct measure_options),
    .work = work,
};
