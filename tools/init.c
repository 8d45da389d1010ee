/* sonject init: asks for what an image does not tell of itself, and writes a scene to begin with.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include <sonject/sonject.h>

#include "base/system/file_system.h"
#include "base/text.h"
#include "console.h"
#include "image_arguments.h"
#include "interview.h"
#include "stage.h"
#include "verbs.h"

#define USUAL_LEVEL_DB 15.0

#define MEMBER(name) offsetof(struct init_options, name)

static const struct argument arguments[] = {
    {"--output", "-o", "SCENE.yaml", "the scene; else the image's name with .yaml", ARGUMENT_TEXT,
     false, MEMBER(output)},
    {"--channel", NULL, "port|starboard|N", "of an XTF or JSF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "in an HDF5 or MATLAB file of several", ARGUMENT_TEXT, false,
     MEMBER(array)},
};

/* Whether the image's file tells what this scene leaves to it. */
static bool file_tells(struct interview *interview, const char *scene_text)
{
    sonject_scene *scene = NULL;
    char *text = NULL;
    sonject_status status = read_image_scene(interview, scene_text, &scene);
    if (status == SONJECT_OK)
        status = sonject_check(interview->context, scene, &text);
    sonject_text_release(&text);
    sonject_scene_release(&scene);
    return status == SONJECT_OK;
}

/* A text as YAML, which JSON is; NULL when memory is out. */
static char *quoted(const char *text)
{
    json_t *value = json_string(text);
    char *found = value ? json_dumps(value, JSON_ENCODE_ANY) : NULL;
    json_decref(value);
    return found;
}

/* Of a path: what follows its folder. */
static const char *last_part(const char *path)
{
    const char *part = path;
    for (; *path; path++)
        part = is_divider(*path) ? path + 1 : part;
    return part;
}

/* "  key: value # comment" in a scene, where there is a value. */
static void add_key(FILE *file, const char *indent, const char *key, const char *value,
                    const char *comment)
{
    if (value)
        fprintf(file, "%s%s: %s%s%s\n", indent, key, value, *comment ? " # " : "", comment);
}

static void write_scene(const struct interview *interview, const char *image, FILE *file)
{
    const struct init_options *options = interview->options;
    const char *array = answer_about(interview, "sonar.array.length");
    fprintf(
        file,
        "# Check it with sonject check, then run it with sonject run. sonject help KEY explains "
        "keys.\nsonject: 1\n\ninput:\n  path: %s\n",
        image);
    add_key(file, "  ", "channel", options->channel, "");
    add_key(file, "  ", "array", options->array, "");
    fprintf(file, "  calibration: %s # grey-level curve, noise floor and more, as measured\n",
            last_part(interview->calibration));
    if (interview->has_geometry) {
        fputs("  geometry: from_file\n", file);
    } else {
        fputs("  geometry:\n", file);
        add_key(file, "    ", "row_spacing", answer_about(interview, "input.geometry.row_spacing"),
                "of pings");
        add_key(file, "    ", "column_spacing",
                answer_about(interview, "input.geometry.column_spacing"),
                "of samples, in slant range");
        add_key(file, "    ", "first_slant_range",
                answer_about(interview, "input.geometry.first_slant_range"),
                interview->has_nadir ? "at the nadir column, which the calibration has"
                                     : "of column 0");
        add_key(file, "    ", "side", answer_about(interview, "input.geometry.side"), "");
    }
    fputs("\nsonar:\n", file);
    if (array)
        fprintf(file, "  kind: real\n  array: {length: %s}\n", array);
    add_key(file, "  ", "frequency", answer_about(interview, "sonar.frequency"),
            "centre of the band");
    add_key(file, "  ", "bandwidth", answer_about(interview, "sonar.bandwidth"),
            interview->assumes_bandwidth
                ? "c / 2 over the column spacing: write your sonar's, which no file tells"
                : "range resolution is c / 2B");
    add_key(file, "  ", "altitude", answer_about(interview, "sonar.altitude"), "over the seabed");
    if (!array)
        fputs("  # resolution: 4 cm # along the track; without it, the row spacing\n", file);
    fputs("\nseabed:\n"
          "  lambert: -27 dB # backscatter strength; it decides how far targets stand out\n"
          "\nobjects: # without a position, in the middle of the image\n"
          "  - name: target\n"
          "    shape: cylinder\n"
          "    length: 1.5 m\n"
          "    diameter: 0.5 m\n"
          "    heading: 30 deg # from along-track towards range\n"
          "    material: steel\n"
          "    # measured pictures show 8 to 19 dB; without this line the material decides\n",
          file);
    const double most_db = floor(interview->ceiling_over_seabed_db);
    if (most_db < USUAL_LEVEL_DB)
        fprintf(file,
                "    level: {over_seabed: %.0f dB} # up to the image's ceiling, as real highlights "
                "are\n",
                most_db);
    else
        fprintf(file, "    level: {over_seabed: %.0f dB}\n", USUAL_LEVEL_DB);
}

/* Writes a file whole or not at all: the scene, or a text instead. False after a message. */
static bool write_file(const struct interview *interview, const char *path, const char *text,
                       const char *image)
{
    char part[NAME + 8], reason[128];
    snprintf(part, sizeof part, "%s.part", path);
    FILE *file = file_open(part, "wb");
    if (file && text)
        fputs(text, file);
    else if (file)
        write_scene(interview, image, file);
    const bool had_failed = !file || ferror(file);
    const bool is_written = file && fclose(file) == 0 && !had_failed;
    const int error = is_written ? file_replace(part, path) : errno;
    if (error == 0)
        return true;
    file_discard(part);
    error_text(error, reason, sizeof reason);
    message(path, ": cannot write: ", reason);
    return false;
}

/* Names of the files: beside each other, in the working folder unless -o says another. The scene
 * names the image from its own folder: as it was given, or from the root. */
static bool name_files(struct interview *interview, char *image, size_t capacity)
{
    const struct init_options *options = interview->options;
    const char *stem = options->output ? options->output : last_part(options->image);
    const char *dot = strrchr(last_part(stem), '.');
    const int bytes = (int)(dot ? (size_t)(dot - stem) : strlen(stem));
    const bool is_elsewhere = last_part(stem) != stem && !path_is_absolute(options->image);
    char *here = is_elsewhere ? working_folder() : NULL;
    const int whole =
        snprintf(image, capacity, "%s%s%s", here ? here : "", here ? "/" : "", options->image);
    free(here);
    const int scene = options->output ? snprintf(interview->scene, NAME, "%s", options->output)
                                      : snprintf(interview->scene, NAME, "%.*s.yaml", bytes, stem);
    const int calibration =
        snprintf(interview->calibration, NAME, "%.*s_calibration.yaml", bytes, stem);
    if (whole < (int)capacity && scene < NAME && calibration < NAME)
        return true;
    message("init: the image's name is too long");
    return false;
}

/* A number among what a calibration measured; NAN where there is none. */
static double measured(const char *calibration, const char *key)
{
    char sought[ANSWER];
    const char *rest;
    double number;
    snprintf(sought, sizeof sought, "\n  %s:\n    value: ", key);
    const char *found = strstr(calibration, sought);
    return found && text_to_number(found + strlen(sought), &number, &rest) ? number : NAN;
}

/* Calibrates the image, and finds out what else it tells. *text: the calibration, for
 * sonject_text_release. */
static sonject_status learn(struct interview *interview, char **text)
{
    const struct init_options *options = interview->options;
    sonject_calibrate_params params = {.struct_size = sizeof params,
                                       .image = options->image,
                                       .channel = options->channel,
                                       .array = options->array};
    message("calibrating ", options->image);
    const sonject_status status = sonject_calibrate(interview->context, &params, text);
    if (status != SONJECT_OK)
        return status;
    const char *nadir = strstr(*text, "nadir_column:"), *end = strstr(*text, "\nmeasured:");
    interview->has_nadir = nadir && end && nadir < end; /* behind it are reasons and errors */
    interview->column_spacing_m = measured(*text, "column_spacing");
    interview->altitude_m = measured(*text, "altitude");
    interview->recorded_altitude_m = measured(*text, "recorded_altitude");
    interview->ceiling_over_seabed_db = measured(*text, "ceiling_over_seabed");
    interview->has_geometry =
        file_tells(interview, "sonject: 1\ninput: {geometry: from_file}\n"
                              "sonar: {altitude: 1 mm, frequency: 1 kHz, bandwidth: 1 Hz}\n");
    interview->has_altitude =
        interview->recorded_altitude_m > 0.0 &&
        file_tells(interview, "sonject: 1\ninput: {geometry: {row_spacing: 1 cm, column_spacing: "
                              "1 cm, first_slant_range: 1 km}}\n"
                              "sonar: {altitude: from_file, frequency: 1 kHz, bandwidth: 1 Hz}\n");
    return SONJECT_OK;
}

/* Gives the exit code. */
static int check(const struct interview *interview)
{
    sonject_scene *scene = NULL;
    const sonject_status status =
        sonject_scene_read(interview->context, interview->scene, NULL, &scene);
    const int code = scene_show(interview->context, status, scene);
    sonject_scene_release(&scene);
    return code;
}

static int hold(struct interview *interview)
{
    char name[2 * NAME], *text = NULL;
    if (!channel_check("init", interview->options->channel) ||
        !name_files(interview, name, sizeof name))
        return EXIT_CODE_USAGE;
    const char *files[] = {interview->scene, interview->calibration};
    for (int i = 0; i < 2; i++)
        if (file_exists(files[i])) {
            message(files[i], ": is there already: choose another scene (-o), or remove it");
            return EXIT_CODE_INPUT;
        }
    const sonject_status status = learn(interview, &text);
    int code = status == SONJECT_OK ? EXIT_CODE_USAGE : fail_with(interview->context, status);
    if (status == SONJECT_OK && ask_all(interview)) {
        char *image = quoted(name);
        const bool is_written = image && write_file(interview, files[1], text, NULL) &&
                                write_file(interview, files[0], NULL, image);
        if (is_written)
            message(files[0], " is a scene to begin with; ", files[1], " has what was measured");
        code = is_written ? check(interview) : EXIT_CODE_STORAGE;
        free(image);
    }
    sonject_text_release(&text);
    return code;
}

static int work(const void *verb_options)
{
    struct interview interview = {.options = verb_options};
    const sonject_context_params params = {.struct_size = sizeof params, .log = progress_note};
    const sonject_status status = sonject_context_create(&params, &interview.context);
    const int code = status == SONJECT_OK ? hold(&interview) : fail_with(NULL, status);
    sonject_context_release(&interview.context);
    return code;
}

const struct verb init_verb = {
    .name = "init",
    .summary = "asks what an image does not tell of itself, and writes a scene for it",
    .operand = "IMAGE",
    .operand_offset = MEMBER(image),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "Calibrates the image, then asks, one line each, for what is left: spacings and ranges\n"
        "that its file does not tell, altitude, frequency, bandwidth, a sidescan's array. Enter\n"
        "takes what stands in brackets. Answers may have units, and may come from a file (init\n"
        "IMAGE <answers). Ends as sonject check does.",
    .options_size = sizeof(struct init_options),
    .work = work,
};
