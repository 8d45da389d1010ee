#include "interview.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/text.h"
#include "console.h"

#define SOUND_SPEED 1500.0 /* m/s, the default of scenes */
#define PI          3.14159265358979323846
#define BEAM_WIDTHS                                                                                \
    0.886 /* array's length in wavelengths, times the half-power beam width in rad */

/* A question and its default answer. usual NULL: an answer must be given. */
struct question {
    const char *key, *text, *usual;
};

static const struct question row_spacing = {
    "input.geometry.row_spacing", "row spacing, from ping to ping along the track (such as 5 cm)",
    NULL};
static const struct question column_spacing = {
    "input.geometry.column_spacing",
    "column spacing, from sample to sample in slant range (such as 2.5 cm)", NULL};
static const struct question first_range = {
    "input.geometry.first_slant_range",
    "slant range of the first column (such as 30 m); if range grows to the left, of the last "
    "column (such as 30 m left); of two sides, the column of the nadir (such as nadir 512)",
    NULL};
static const struct question side = {
    "input.geometry.side", "side of the track to put targets into, port or starboard", "port"};
static const struct question altitude = {
    "sonar.altitude", "altitude of the sonar over the seabed (such as 10 m, or from_file)", NULL};
static const struct question frequency = {"sonar.frequency", "centre frequency (such as 100 kHz)",
                                          NULL};
static const struct question bandwidth = {
    "sonar.bandwidth", "bandwidth (if unknown, take c / 2 divided by the column spacing)", NULL};
static const struct question array_length = {
    "sonar.array.length",
    "length of the sidescan's array, or its beam width (such as 0.5 m or 0.4 deg; empty for "
    "synthetic aperture)",
    ""};
static const struct question unit = {"objects[0].mesh.unit",
                                     "unit of the mesh's numbers (m, cm or mm)", NULL};
static const struct question nose = {
    "objects[0].mesh.nose", "axis of the mesh that points ahead (x, -x, y, -y, z, -z)", "x"};

const char *answer_about(const struct interview *interview, const char *key)
{
    const size_t length = strlen(key);
    for (size_t i = 0; i < interview->count; i++)
        if (strncmp(interview->answers[i], key, length) == 0 &&
            interview->answers[i][length] == '=')
            return interview->answers[i] + length + 1;
    return NULL;
}

/* Writes key=name. The name is in quotes (JSON), since it may have characters that mean something
 * to YAML. An array's that is not UTF-8 stays as it is, and whoever reads it says so. */
static void write_name(char override[2 * NAME], const char *key, const char *name)
{
    json_t *value = json_string(name);
    char *quoted = value ? json_dumps(value, JSON_ENCODE_ANY) : NULL;
    snprintf(override, 2 * NAME, "%s=%s", key, quoted ? quoted : name);
    free(quoted);
    json_decref(value);
}

sonject_status read_image_scene(const struct interview *interview, const char *text,
                                sonject_scene **scene)
{
    const struct init_options *options = interview->options;
    const char *overrides[ANSWERS + 6];
    char path[2 * NAME], channel[ANSWER], array[2 * NAME];
    uint32_t count = 0;
    write_name(path, "input.path", options->image);
    snprintf(channel, sizeof channel, "input.channel=%s", options->channel ? options->channel : "");
    write_name(array, "input.array", options->array ? options->array : "");
    overrides[count++] = path;
    if (options->channel)
        overrides[count++] = channel;
    if (options->array)
        overrides[count++] = array;
    if (interview->is_complex)
        overrides[count++] = "input.complex=true";
    if (answer_about(interview, array_length.key))
        overrides[count++] = "sonar.kind=real";
    if (interview->objects && (interview->count == 0 || answer_about(interview, unit.key)))
        overrides[count++] = interview->objects;
    for (size_t i = 0; i < interview->count; i++)
        if (!interview->has_returns ||
            strcmp(interview->answers[i], "sonar.altitude=first_return") != 0)
            overrides[count++] = interview->answers[i]; /* not before the calibration is written */
    const sonject_scene_read_params params = {.struct_size = sizeof params,
                                              .text = text,
                                              .overrides = overrides,
                                              .override_count = count};
    return sonject_scene_read(interview->context, NULL, &params, scene);
}

/* Returns a number of the scene in SI units; NAN if the scene does not have it. */
static double number_in(const sonject_scene *scene, const char *key)
{
    char *json = NULL;
    (void)sonject_scene_get(scene, key, &json);
    const double number = json ? strtod(json, NULL) : NAN;
    sonject_text_release(&json);
    return number;
}

/* Returns whether a scene with the answers so far can be read; leaves a message if not. */
static bool is_possible(struct interview *interview)
{
    sonject_scene *scene = NULL;
    sonject_status status = read_image_scene(
        interview,
        interview->has_geometry
            ? "sonject: 1\ninput: {geometry: from_file}\n"
              "sonar: {altitude: 10 m, frequency: 100 kHz, bandwidth: 10 kHz}\n"
            : "sonject: 1\nsonar: {altitude: 10 m, frequency: 100 kHz, bandwidth: 10 kHz}\n"
              "input: {geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 30 "
              "m}}\n",
        &scene);
    if (status == SONJECT_OK && answer_about(interview, column_spacing.key))
        interview->column_spacing_m = number_in(scene, column_spacing.key);
    if (status == SONJECT_OK && answer_about(interview, frequency.key))
        interview->frequency_hz = number_in(scene, frequency.key);
    sonject_scene_release(&scene);
    return status == SONJECT_OK;
}

/* Returns the length of an array whose beam width is the answer; the answer itself if it is no
 * angle. */
static const char *length_of_beam(const struct interview *interview, const char *answer,
                                  char length[ANSWER])
{
    const char *rest;
    double degrees;
    if (!text_to_number(answer, &degrees, &rest) || !(degrees > 0.0) ||
        strcmp(rest + strspn(rest, " "), "deg") != 0)
        return answer;
    snprintf(length, ANSWER, "%.3g m",
             BEAM_WIDTHS * SOUND_SPEED / interview->frequency_hz / (degrees * PI / 180.0));
    return length;
}

/* Returns the answer without the word "left" at its end; *is_left: whether it was there. */
static const char *length_of_range(const char *answer, char length[ANSWER], bool *is_left)
{
    const char *end = strstr(answer, "left");
    *is_left = end && end > answer && end[4] == '\0';
    while (*is_left && end[-1] == ' ' && end - 1 > answer)
        end--;
    snprintf(length, ANSWER, "%.*s", *is_left ? (int)(end - answer) : ANSWER - 1, answer);
    return length;
}

/* Makes the last column, whose slant range was answered, the nadir of range to the left. */
static void add_reversed(struct interview *interview)
{
    snprintf(interview->answers[interview->count++], ANSWER, "input.geometry.nadir_column=%.0f",
             interview->columns - 1.0);
    snprintf(interview->answers[interview->count++], ANSWER, "input.geometry.side=port");
}

/* Returns the reason why a scene with the answers so far cannot be read. */
static const char *problem_of(const struct interview *interview)
{
    const char *problem = sonject_context_message(interview->context);
    const char *rest = strstr(problem, ": ");
    return rest ? rest + 2 : problem;
}

/* Takes the column of the nadir between two sides as an answer. Returns NULL, or why it is not
 * possible. */
static const char *take_nadir(struct interview *interview, const char *column)
{
    const size_t before = interview->count;
    interview->is_reversed = false;
    snprintf(interview->answers[interview->count++], ANSWER, "input.geometry.nadir_column=%s",
             column);
    snprintf(interview->answers[interview->count++], ANSWER, "input.geometry.side=port");
    const bool is_read = is_possible(interview);
    interview->count = before;
    if (!is_read)
        return problem_of(interview);
    interview->nadir_column = strtod(column, NULL);
    if (!(interview->nadir_column < interview->columns - 1.0))
        return "the image has no columns to the right of it";
    interview->has_nadir = true;
    interview->count++; /* the side is asked for */
    return NULL;
}

/* Takes an answer. Returns NULL, or why it is not possible. */
static const char *take(struct interview *interview, const struct question *question,
                        const char *value)
{
    static const char nadir[] = "nadir ";
    char converted[ANSWER];
    if (question == &first_range && strncmp(value, nadir, sizeof nadir - 1) == 0)
        return take_nadir(interview, value + sizeof nadir - 1);
    if (question == &array_length)
        value = length_of_beam(interview, value, converted);
    if (question == &first_range)
        value = length_of_range(value, converted, &interview->is_reversed);
    const int length =
        snprintf(interview->answers[interview->count++], ANSWER, "%s=%s", question->key, value);
    if (length >= ANSWER || !is_possible(interview)) {
        interview->count--;
        return length < ANSWER ? problem_of(interview) : "too long";
    }
    if (question == &first_range && interview->is_reversed)
        add_reversed(interview);
    return NULL;
}

/* Asks until the answer is possible. Returns false after a message if the input ends. */
static bool ask(struct interview *interview, const struct question *question)
{
    char line[ANSWER];
    for (;;) {
        const bool has_usual = question->usual && *question->usual;
        fprintf(stderr, "%s%s%s%s: ", question->text, has_usual ? " [" : "",
                has_usual ? question->usual : "", has_usual ? "]" : "");
        fflush(stderr);
        if (!fgets(line, sizeof line, stdin)) {
            fputc('\n', stderr);
            message("init: no answer was given for ", question->key);
            return false;
        }
        line[strcspn(line, "\r\n")] = '\0';
        const char *value = line + strspn(line, " \t");
        if (!*value && question->usual) {
            if (!has_usual)
                return true; /* an empty answer is allowed */
            value = question->usual;
        }
        if (!*value)
            continue;
        const char *problem = take(interview, question, value);
        if (!problem)
            return true;
        message("init: the answer '", value, "': ", problem);
    }
}

/* Asks for the altitude. The default is first returns, else the altitude in the file. */
static bool ask_altitude(struct interview *interview)
{
    struct question question = altitude;
    const bool has_returns = interview->has_returns;
    char text[3 * ANSWER], median[ANSWER] = "", recorded[ANSWER] = "";
    if (interview->altitude_m > 0.0)
        snprintf(median, sizeof median, ", %.4g m in the median", interview->altitude_m);
    if (interview->has_altitude)
        snprintf(recorded, sizeof recorded, "from_file: as recorded, %.4g m in the %s; ",
                 interview->recorded_altitude_m, has_returns ? "median" : "mean");
    snprintf(text, sizeof text, "altitude of the sonar over the seabed (%s%s%s%sor a number)",
             has_returns ? "first_return: from the first return of each ping" : "",
             has_returns ? median : "", has_returns ? "; " : "", recorded);
    if (has_returns || interview->has_altitude) {
        question.text = text;
        question.usual = has_returns ? "first_return" : "from_file";
    }
    return ask(interview, &question);
}

/* Asks for the bandwidth, which no file has. The default is that of the column spacing. */
static bool ask_bandwidth(struct interview *interview)
{
    struct question question = bandwidth;
    char usual[ANSWER];
    snprintf(usual, sizeof usual, "%.4g kHz", 0.5e-3 * SOUND_SPEED / interview->column_spacing_m);
    question.usual = usual;
    if (!ask(interview, &question))
        return false;
    interview->assumes_bandwidth = strcmp(answer_about(interview, bandwidth.key), usual) == 0;
    return true;
}

bool ask_all(struct interview *interview)
{
    return (interview->has_geometry ||
            (ask(interview, &row_spacing) && ask(interview, &column_spacing) &&
             (interview->has_nadir || ask(interview, &first_range)))) &&
           (!interview->has_nadir || ask(interview, &side)) && ask_altitude(interview) &&
           ask(interview, &frequency) && ask_bandwidth(interview) &&
           ask(interview, &array_length) &&
           (!interview->has_mesh || (ask(interview, &unit) && ask(interview, &nose)));
}
