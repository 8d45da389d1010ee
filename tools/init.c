/* sonject init: asks for what an image does not tell, and writes a first scene. */
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
#include "init_files.h"
#include "interview.h"
#include "stage.h"
#include "verbs.h"

#define MEMBER(name) offsetof(struct init_options, name)

static const struct argument arguments[] = {
    {"--output", "-o", "SCENE.yaml", "scene to write; by default the image's name with .yaml",
     ARGUMENT_TEXT, false, MEMBER(output)},
    {"--channel", NULL, "port|starboard|N", "channel of an XTF or JSF file", ARGUMENT_TEXT, false,
     MEMBER(channel)},
    {"--array", NULL, "NAME", "array of an HDF5 or MATLAB file that has several", ARGUMENT_TEXT,
     false, MEMBER(array)},
    {"--target", NULL, "FILE", "a mesh (STL, PLY, OBJ) or a target (YAML); by default a cylinder",
     ARGUMENT_TEXT, false, MEMBER(target)},
    {"--campaign", NULL, NULL, "also write a campaign, with both sides if the image has two",
     ARGUMENT_FLAG, false, MEMBER(makes_campaign)},
};

/* Returns whether the image's file has the facts that this scene leaves to the file. */
static bool file_tells(const struct interview *interview, const char *scene_text)
{
    sonject_scene *scene = NULL;
    char *text = NULL;
    struct interview without = *interview;
    without.objects = NULL;
    sonject_status status = read_image_scene(&without, scene_text, &scene);
    if (status == SONJECT_OK)
        status = sonject_check(interview->context, scene, &text);
    sonject_text_release(&text);
    sonject_scene_release(&scene);
    return status == SONJECT_OK;
}

/* Names a file that is made beside the scene. Returns whether the name fits. */
static bool name_file(char *name, const struct interview *interview, const char *end)
{
    const struct init_options *options = interview->options;
    const char *stem = options->output ? options->output : last_part(options->image);
    const char *dot = strrchr(last_part(stem), '.');
    const int bytes = (int)(dot ? (size_t)(dot - stem) : strlen(stem));
    return snprintf(name, NAME, "%.*s%s", bytes, stem, end) < NAME;
}

/* Returns the other side of a recording; NULL if the channel is a number, or none. */
static const char *other_side(const struct init_options *options)
{
    const char *channel = options->channel ? options->channel : "";
    return strcmp(channel, "port") == 0        ? "starboard"
           : strcmp(channel, "starboard") == 0 ? "port"
                                               : NULL;
}

/* Names the files of one side of a recording, or of all of it. Returns whether the names fit. */
static bool name_side(const struct interview *interview, const char *side, char *calibration,
                      char *picture)
{
    char end[64];
    snprintf(end, sizeof end, "%s_calibration.yaml", side);
    const bool is_named = name_file(calibration, interview, end);
    snprintf(end, sizeof end, "%s_quicklook.png", side);
    return name_file(picture, interview, end) && is_named;
}

/* Names the files. They lie side by side, in the working folder unless -o names another. The scene
 * names the image from its own folder: as given, or absolutely. */
static bool name_files(struct interview *interview)
{
    const struct init_options *options = interview->options;
    const char *output = options->output;
    const char *other = other_side(options);
    char end[64];
    char *here = output && last_part(output) != output ? working_folder() : NULL;
    snprintf(end, sizeof end, "_%s", other ? other : "");
    const bool is_named =
        snprintf(interview->folder, NAME, "%s", here ? here : "") < NAME &&
        name_side(interview, "", interview->calibration, interview->picture) &&
        name_side(interview, end, interview->other_calibration, interview->other_picture) &&
        name_file(interview->campaign, interview, "_campaign.yaml") &&
        (output ? snprintf(interview->scene, NAME, "%s", output) < NAME
                : name_file(interview->scene, interview, ".yaml"));
    if (!other || !options->makes_campaign)
        *interview->other_calibration = *interview->other_picture = '\0';
    if (!options->makes_campaign)
        *interview->campaign = '\0';
    free(here);
    if (!is_named)
        message("init: the image's name is too long");
    return is_named;
}

/* Returns whether no file to be made exists. */
static bool are_free(const struct interview *interview)
{
    const char *files[] = {
        interview->scene,    interview->calibration,       interview->picture,
        interview->campaign, interview->other_calibration, interview->other_picture};
    for (int i = 0; i < 6; i++)
        if (*files[i] && file_exists(files[i])) {
            message(files[i], ": already exists: choose another scene (-o), or remove it");
            return false;
        }
    return true;
}

/* Returns an override that makes the target's file the scene's only object, a mesh in a unit. NULL
 * when memory is out. */
static char *objects_override(const struct interview *interview, const char *unit)
{
    const char *target = interview->options->target;
    json_t *object = interview->has_mesh ? json_pack("{s:s, s:{s:s, s:s}}", "shape", "mesh", "mesh",
                                                     "file", target, "unit", unit)
                                         : json_pack("{s:s}", "target", target);
    char *text = object ? json_dumps(object, 0) : NULL;
    const size_t bytes = text ? strlen(text) + sizeof "objects=[]" : 0;
    char *override = text ? malloc(bytes) : NULL;
    if (override)
        snprintf(override, bytes, "objects=[%s]", text);
    free(text);
    json_decref(object);
    return override;
}

/* Checks that the target can be read, a mesh in any of the units; its unit is asked for later. */
static sonject_status take_target(struct interview *interview)
{
    static const char *const units[] = {"m", "cm", "mm"};
    const char *target = interview->options->target;
    const char *dot = target ? strrchr(target, '.') : NULL;
    sonject_status status = SONJECT_OK;
    interview->has_mesh =
        target && (!dot || (strcmp(dot, ".yaml") != 0 && strcmp(dot, ".yml") != 0));
    for (int i = 0; target && i < 3; i++) {
        sonject_scene *scene = NULL;
        free(interview->objects);
        interview->objects = objects_override(interview, units[i]);
        if (!interview->objects)
            return SONJECT_ERROR_MEMORY;
        status = read_image_scene(
            interview,
            "sonject: 1\nsonar: {altitude: 10 m, frequency: 100 kHz, bandwidth: 10 kHz}\ninput: "
            "{geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 30 m}}\n",
            &scene);
        sonject_scene_release(&scene);
        if (status == SONJECT_OK)
            break;
    }
    return status;
}

/* Returns a number that a calibration measured; NAN if there is none. */
static double measured(const char *calibration, const char *key)
{
    char sought[ANSWER];
    const char *rest;
    double number;
    snprintf(sought, sizeof sought, "\n  %s:\n    value: ", key);
    const char *found = strstr(calibration, sought);
    return found && text_to_number(found + strlen(sought), &number, &rest) ? number : NAN;
}

/* Returns the row or column of the plain place whose level the calibration gives; NAN if none. */
static double placed(const char *calibration, const char *axis)
{
    char sought[ANSWER];
    const char *rest;
    double number;
    const char *seabed = strstr(calibration, "\n  seabed_level:\n    value: ");
    snprintf(sought, sizeof sought, "\n    %s: ", axis);
    const char *found = seabed ? strstr(seabed, sought) : NULL;
    return found && text_to_number(found + strlen(sought), &number, &rest) ? number : NAN;
}

static sonject_status calibrate(const struct interview *interview, sonject_context *context,
                                const char *channel, char **text)
{
    const sonject_calibrate_params params = {.struct_size = sizeof params,
                                             .image = interview->options->image,
                                             .channel = channel,
                                             .array = interview->options->array};
    message("calibrating ", params.image, channel ? ", " : "", channel ? channel : "");
    return sonject_calibrate(context, &params, text);
}

/* Calibrates the image, and finds out what else it tells. *text: the calibration, for
 * sonject_text_release. */
static sonject_status learn(struct interview *interview, char **text)
{
    const struct init_options *options = interview->options;
    const sonject_status status = calibrate(interview, interview->context, options->channel, text);
    if (status != SONJECT_OK)
        return status;
    interview->has_returns = strstr(*text, "\n  first_return:") != NULL;
    const char *columns = strstr(*text, "\n  columns: ");
    interview->columns = columns ? strtod(columns + strlen("\n  columns: "), NULL) : NAN;
    interview->nadir_column = measured(*text, "nadir_column");
    interview->has_nadir = isfinite(interview->nadir_column); /* of two sides alone */
    interview->column_spacing_m = measured(*text, "column_spacing");
    interview->altitude_m = measured(*text, "altitude");
    interview->recorded_altitude_m = measured(*text, "recorded_altitude");
    interview->full_scale = measured(*text, "full_scale");
    interview->largest_number = measured(*text, "largest_number");
    interview->ceiling_over_seabed_db = measured(*text, "ceiling_over_seabed");
    interview->seabed_db = measured(*text, "seabed_level");
    interview->is_decibel = strstr(*text, "\n    kind: decibel") != NULL;
    interview->is_amplitude = strstr(*text, "\n    kind: amplitude") != NULL;
    interview->plain_row = placed(*text, "row");
    interview->plain_column = placed(*text, "column");
    interview->is_complex =
        file_tells(interview, "sonject: 1\ninput: {complex: true, geometry: {row_spacing: 1 cm, "
                              "column_spacing: 1 cm, first_slant_range: 1 km}}\n"
                              "sonar: {altitude: 1 mm, frequency: 1 kHz, bandwidth: 1 Hz}\n");
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

/* Calibrates the other side without a log: notes are about the recording, and were shown before. */
static void learn_other_side(struct interview *interview, char **text)
{
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = calibrate(interview, context, other_side(interview->options), text);
    if (status != SONJECT_OK)
        *interview->other_calibration = *interview->other_picture = '\0'; /* no such side */
    sonject_context_release(&context);
}

/* Writes the curve that a calibration gives as one line, such as {kind: gamma, parameter: 2.2}.
 * Returns it, or NULL if there is none. */
static const char *curve_of(const char *calibration, char curve[4 * ANSWER])
{
    const char *from = strstr(calibration, "\n  transfer:\n");
    const char *end = strstr(calibration, "\nmeasured:");
    size_t length = 0;
    if (!from || (end && from > end))
        return NULL;
    for (const char *line = from + strlen("\n  transfer:\n"); strncmp(line, "    ", 4) == 0;) {
        const int bytes = (int)strcspn(line, "\n");
        length += (size_t)snprintf(curve + length, 4 * ANSWER - length, "%s%.*s",
                                   length > 0 ? ", " : "{", bytes - 4, line + 4);
        if (length + 2 > 4 * ANSWER)
            return NULL;
        line += bytes + (line[bytes] == '\n');
    }
    snprintf(curve + length, 4 * ANSWER - length, "}");
    return length > 0 ? curve : NULL;
}

/* Draws a side of the image, or both sides about the nadir, by the curve that was measured. */
static sonject_status draw(const struct interview *interview, const char *channel,
                           const char *calibration, const char *picture)
{
    char geometry[4 * ANSWER], curve[4 * ANSWER];
    const sonject_quicklook_params params = {
        .struct_size = sizeof params,
        .image = interview->options->image,
        .picture = picture,
        .channel = channel,
        .array = interview->options->array,
        .transfer = interview->is_complex ? NULL : curve_of(calibration, curve),
        .geometry = interview->has_geometry ? NULL : geometry};
    if (!interview->has_geometry) {
        const int length =
            snprintf(geometry, sizeof geometry, "{row_spacing: %s, column_spacing: %s",
                     answer_about(interview, "input.geometry.row_spacing"),
                     answer_about(interview, "input.geometry.column_spacing"));
        char *rest = geometry + length;
        const size_t left = sizeof geometry - (size_t)length;
        if (interview->has_nadir)
            snprintf(rest, left, ", nadir_column: %.17g, side: starboard}",
                     interview->nadir_column);
        else
            snprintf(rest, left, ", first_slant_range: %s%s%s}",
                     answer_about(interview, "input.geometry.first_slant_range"),
                     interview->is_reversed ? ", side: port, nadir_column: " : "",
                     interview->is_reversed ? answer_about(interview, "input.geometry.nadir_column")
                                            : "");
    }
    return sonject_quicklook(interview->context, &params);
}

/* Removes the files of a scene that an answer made unusable, so that the same command can ask
 * again. */
static void remove_files(const struct interview *interview)
{
    const char *const files[] = {interview->scene, interview->calibration, interview->picture,
                                 interview->other_calibration, interview->other_picture};
    for (int i = 0; i < 5; i++)
        if (*files[i] && file_exists(files[i]))
            (void)remove(files[i]);
    message("init: no file is left: give the command again, with other answers if they were wrong");
}

/* Writes the scene and its files, and checks the scene as sonject check does. Returns the exit
 * code. */
static int write_files(struct interview *interview, const char *calibration, const char *other)
{
    sonject_scene *scene = NULL;
    char *checked = NULL;
    if (!write_calibration(interview->calibration, calibration) ||
        (other && !write_calibration(interview->other_calibration, other)) ||
        !write_scene(interview))
        return EXIT_CODE_STORAGE;
    sonject_status status = sonject_scene_read(interview->context, interview->scene, NULL, &scene);
    if (status == SONJECT_OK)
        status = sonject_check(interview->context, scene, &checked);
    if (status == SONJECT_OK)
        status = draw(interview, interview->options->channel, calibration, interview->picture);
    if (status == SONJECT_OK && other)
        status = draw(interview, other_side(interview->options), other, interview->other_picture);
    sonject_scene_release(&scene);
    if (status != SONJECT_OK) {
        const int code = fail_with(interview->context, status);
        remove_files(interview);
        return code;
    }
    const bool is_written = !*interview->campaign || write_campaign(interview, checked);
    fputs(checked, stdout);
    sonject_text_release(&checked);
    if (!is_written)
        return EXIT_CODE_STORAGE;
    message(interview->scene, " is a scene to begin with; ", interview->calibration,
            " has what was measured; ", interview->picture, " shows the image");
    if (*interview->campaign)
        message(interview->campaign, " is a campaign to begin with");
    return finish_output();
}

/* Scenes are UTF-8 text, and so are the names of files in them. */
static bool can_be_named(const char *name)
{
    json_t *text = name ? json_string(name) : NULL;
    const bool is_text = !name || text;
    json_decref(text);
    if (!is_text)
        message("init: the file name '", name, "' is not UTF-8 text: rename the file");
    return is_text;
}

static int hold(struct interview *interview)
{
    char *text = NULL, *other = NULL;
    const struct init_options *options = interview->options;
    if (!can_be_named(options->image) || !can_be_named(options->target) ||
        !can_be_named(options->output))
        return EXIT_CODE_INPUT;
    if (!channel_check("init", interview->options->channel) || !name_files(interview))
        return EXIT_CODE_USAGE;
    if (!are_free(interview))
        return EXIT_CODE_INPUT;
    sonject_status status = take_target(interview);
    if (status == SONJECT_OK)
        status = learn(interview, &text);
    if (status == SONJECT_OK && *interview->other_calibration)
        learn_other_side(interview, &other);
    int code = status == SONJECT_OK ? EXIT_CODE_USAGE : fail_with(interview->context, status);
    if (status == SONJECT_OK && ask_all(interview))
        code = write_files(interview, text, other);
    sonject_text_release(&text);
    sonject_text_release(&other);
    return code;
}

static int work(const void *verb_options)
{
    struct interview interview = {.options = verb_options};
    const sonject_context_params params = {.struct_size = sizeof params, .log = progress_note};
    const sonject_status status = sonject_context_create(&params, &interview.context);
    const int code = status == SONJECT_OK ? hold(&interview) : fail_with(NULL, status);
    sonject_context_release(&interview.context);
    free(interview.objects);
    return code;
}

const struct verb init_verb = {
    .name = "init",
    .summary = "asks for what an image file does not say, and writes a scene for it",
    .operand = "IMAGE",
    .operand_offset = MEMBER(image),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "Calibrates the image, then asks for the rest, line by line: spacings and ranges that the "
        "file\n"
        "does not have, altitude, frequency, bandwidth, a sidescan's array, a mesh's unit. Enter "
        "takes\n"
        "the answer in brackets. Answers may have units, and may come from a file (init IMAGE\n"
        "<answers). At the end it prints what sonject check prints.",
    .options_size = sizeof(struct init_options),
    .work = work,
};
