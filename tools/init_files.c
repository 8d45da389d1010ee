#include "init_files.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/system/file_system.h"
#include "base/text.h"
#include "console.h"

#define USUAL_LEVEL_DB  15.0
#define OVER_CEILING_DB 2.0  /* a peak's excess over the ceiling, as its place is dark */
#define FAINTEST_DB     8.0  /* faintest peaks of a campaign; measured ones have 8 to 19 dB */
#define HIGHLIGHTS_DB   20.0 /* white over seabed */
#define SHADOWS_DB      35.0 /* seabed over black; darker shadows need no grey levels */
#define CHIP_MOST       512.0

const char *last_part(const char *path)
{
    const char *part = path;
    for (; *path; path++)
        part = is_divider(*path) ? path + 1 : part;
    return part;
}

/* ---- One file. */

/* Opens a file that finish() publishes; NULL after a message. */
static FILE *begin(const char *path, char part[NAME + 8])
{
    char reason[128];
    snprintf(part, NAME + 8, "%s.part", path);
    FILE *file = file_open(part, "wb");
    if (!file) {
        error_text(errno, reason, sizeof reason);
        message(path, ": cannot write: ", reason);
    }
    return file;
}

static bool finish(FILE *file, const char *part, const char *path)
{
    char reason[128];
    const bool had_failed = ferror(file) != 0;
    const bool is_written = fclose(file) == 0 && !had_failed;
    const int error = is_written ? file_replace(part, path) : errno;
    if (error == 0)
        return true;
    file_discard(part);
    error_text(error, reason, sizeof reason);
    message(path, ": cannot write: ", reason);
    return false;
}

bool write_calibration(const char *path, const char *text)
{
    char part[NAME + 8];
    FILE *file = begin(path, part);
    if (!file)
        return false;
    fputs(text, file);
    return finish(file, part, path);
}

/* ---- Pieces of scenes and campaigns. */

/* Adds a text as YAML (JSON), behind a key. If memory is out, the value is missing, and whoever
 * reads the file is told. */
static void add_text(FILE *file, const char *before, const char *text)
{
    json_t *value = json_string(text);
    char *quoted = value ? json_dumps(value, JSON_ENCODE_ANY) : NULL;
    fprintf(file, "%s%s", before, quoted ? quoted : "");
    free(quoted);
    json_decref(value);
}

/* Adds "  key: value # comment" to a scene if there is a value. */
static void add_key(FILE *file, const char *indent, const char *key, const char *value,
                    const char *comment)
{
    if (value)
        fprintf(file, "%s%s: %s%s%s\n", indent, key, value, *comment ? " # " : "", comment);
}

/* Adds a file's name as seen from the scene's folder, which may not be the working folder. */
static void add_path(FILE *file, const char *before, const struct interview *interview,
                     const char *path)
{
    char whole[2 * NAME];
    const bool is_moved = *interview->folder && !path_is_absolute(path);
    snprintf(whole, sizeof whole, "%s%s%s", is_moved ? interview->folder : "", is_moved ? "/" : "",
             path);
    add_text(file, before, whole);
}

static bool is_mesh(const struct interview *interview)
{
    return answer_about(interview, "objects[0].mesh.unit") != NULL;
}

/* Adds the keys that describe the target, with a separator between them. */
static void add_target(FILE *file, const struct interview *interview, const char *between)
{
    const char *target = interview->options->target;
    if (!target) {
        fprintf(file, "shape: cylinder%slength: 1.5 m%sdiameter: 0.5 m%smaterial: steel", between,
                between, between);
    } else if (is_mesh(interview)) {
        fprintf(file, "shape: mesh%s", between);
        add_path(file, "mesh: {file: ", interview, target);
        fprintf(file, ", unit: %s, nose: %s}", answer_about(interview, "objects[0].mesh.unit"),
                answer_about(interview, "objects[0].mesh.nose"));
    } else {
        add_path(file, "target: ", interview, target);
    }
}

/* Adds the name of the target's file without its extension. */
static void add_name(FILE *file, const char *before, const struct interview *interview)
{
    char name[NAME];
    const char *target = interview->options->target;
    snprintf(name, sizeof name, "%s", target ? last_part(target) : "cylinder");
    name[strcspn(name, ".")] = '\0';
    add_text(file, before, *name ? name : "target");
}

static double highest_level_db(const struct interview *interview)
{
    return fmin(floor(fmin(INFINITY, interview->ceiling_over_seabed_db + OVER_CEILING_DB)),
                USUAL_LEVEL_DB);
}

/* ---- The scene. */

static void add_input(FILE *file, const struct interview *interview)
{
    const struct init_options *options = interview->options;
    add_path(file, "input:\n  path: ", interview, options->image);
    fputc('\n', file);
    add_key(file, "  ", "channel", options->channel, "");
    if (options->array) {
        add_text(file, "  array: ", options->array);
        fputc('\n', file);
    }
    if (interview->is_complex)
        fputs("  complex: true # the two channels are real and imaginary part\n", file);
    add_text(file, "  calibration: ", last_part(interview->calibration));
    fputs(" # grey-level curve, noise floor and more, as measured\n", file);
    if (interview->has_geometry) {
        fputs("  geometry: from_file\n", file);
        return;
    }
    fputs("  geometry:\n", file);
    add_key(file, "    ", "row_spacing", answer_about(interview, "input.geometry.row_spacing"),
            "between pings");
    add_key(file, "    ", "column_spacing",
            answer_about(interview, "input.geometry.column_spacing"),
            "between samples, in slant range");
    add_key(file, "    ", "first_slant_range",
            answer_about(interview, "input.geometry.first_slant_range"),
            interview->is_reversed ? "of the nadir column" : "of column 0");
    add_key(file, "    ", "nadir_column", answer_about(interview, "input.geometry.nadir_column"),
            interview->has_nadir ? "range grows to both sides"
                                 : "the last column: range grows to the left");
    add_key(file, "    ", "side", answer_about(interview, "input.geometry.side"),
            interview->is_reversed ? "left of the nadir column"
            : answer_about(interview, "input.geometry.nadir_column")
                ? "of the nadir column"
                : "of the nadir column, which is in the calibration");
}

static void add_sonar(FILE *file, const struct interview *interview)
{
    const char *array = answer_about(interview, "sonar.array.length");
    fputs("\nsonar:\n", file);
    if (array)
        fprintf(file, "  kind: real\n  array: {length: %s}\n", array);
    add_key(file, "  ", "frequency", answer_about(interview, "sonar.frequency"),
            "centre of the band");
    add_key(file, "  ", "bandwidth", answer_about(interview, "sonar.bandwidth"),
            interview->assumes_bandwidth
                ? "c / 2 divided by the column spacing: write your sonar's own, which no file has"
                : "range resolution is c / 2B");
    add_key(file, "  ", "altitude", answer_about(interview, "sonar.altitude"), "over the seabed");
    if (!array)
        fputs("  # resolution: 4 cm # along the track; without it, the row spacing\n", file);
}

bool write_scene(const struct interview *interview)
{
    char part[NAME + 8];
    FILE *file = begin(interview->scene, part);
    if (!file)
        return false;
    fputs("# Check it with sonject check, then run it with sonject run. sonject help KEY explains "
          "keys.\nsonject: 1\n\n",
          file);
    add_input(file, interview);
    add_sonar(file, interview);
    fputs(
        "\nseabed:\n"
        "  lambert: -27 dB # backscatter strength; it decides how far targets stand out\n"
        "  # relief: [{scour: {width: 50 cm, depth: 5 cm}}] # as currents wash out around objects\n"
        "\nobjects:\n",
        file);
    add_name(file, "  - name: ", interview);
    fputs("\n    ", file);
    add_target(file, interview, "\n    ");
    if (interview->has_nadir || isnan(interview->plain_row))
        fprintf(file,
                "\n    # position: {row: 100, column: 200} # without it, the middle of the %s",
                interview->has_nadir ? "side" : "image");
    else
        fprintf(file, "\n    position: {row: %.0f, column: %.0f} # a plain place of the seabed",
                interview->plain_row, interview->plain_column);
    const double level_db = highest_level_db(interview);
    fprintf(file,
            "\n"
            "    heading: 30 deg # from along-track towards range\n"
            "    # of the echo's peak; measured ones have 8 to 19 dB. Without this line the "
            "material decides it\n"
            "    level: {over_seabed: %.0f dB}%s\n",
            level_db,
            level_db < USUAL_LEVEL_DB ? " # as much as the image's ceiling allows: more is cut off"
                                      : "");
    return finish(file, part, interview->scene);
}

/* ---- The campaign. */

/* Facts about the side with the target, from the text of sonject_check. */
struct checked {
    double rows, columns, along_m, first_m, last_m, altitude_m, top_m;
};

static void read_checked(struct checked *checked, const char *text)
{
    memset(checked, 0, sizeof *checked);
    for (const char *line = text; *line; line += *line == '\n') {
        const char *top = strstr(line, ", top ");
        const char *altitude = strstr(line, ", altitude ");
        sscanf(line, "patch %lf x %lf pixels", &checked->rows, &checked->columns);
        sscanf(line, " %lf m along-track, slant range %lf...%lf m", &checked->along_m,
               &checked->first_m, &checked->last_m);
        if (altitude)
            sscanf(altitude, ", altitude %lf m", &checked->altitude_m);
        if (top)
            sscanf(top, ", top %lf m", &checked->top_m);
        line += strcspn(line, "\n");
    }
}

/* Returns the pixels of a length, rounded up to a multiple of step and kept within limits. */
static unsigned chip_pixels(double length_m, double image_m, double image_pixels, double step)
{
    const double wanted = ceil(length_m / image_m * image_pixels / step) * step;
    const double most = fmin(CHIP_MOST, floor(image_pixels / step) * step);
    return (unsigned)fmax(step, fmin(most, fmax(wanted, 2.0 * step)));
}

/* Adds chips with room for a shadow to either side of the target. A shadow is half as long again as
 * at three quarters of the range and at the median altitude. Chips are as long along the track. */
static void add_chip(FILE *file, const struct interview *interview, const char *text)
{
    struct checked checked;
    read_checked(&checked, text);
    const double range_m = checked.first_m + 0.75 * (checked.last_m - checked.first_m);
    const double altitude_m =
        interview->altitude_m > 0.0 ? interview->altitude_m : checked.altitude_m;
    const double below_m = fmax(altitude_m - checked.top_m, 0.1 * altitude_m);
    const double length_m = 2.0 * 1.5 * range_m * checked.top_m / below_m;
    fprintf(file, "chip: {rows: %u, columns: %u, spread: 0.2} # a row is %.3g m, a column %.3g m\n",
            chip_pixels(length_m, checked.along_m, checked.rows, 16.0),
            chip_pixels(length_m, checked.last_m - checked.first_m, checked.columns, 32.0),
            checked.along_m / checked.rows,
            (checked.last_m - checked.first_m) / (checked.columns - 1.0));
}

/* Adds grey levels for detectors, which read 8 bits: from well below shadows to the ceiling, which
 * is the largest number where nothing clips. Floats have none: there, white is over bright
 * highlights. Levels over full scale do not suit numbers that are decibels. */
static void add_grey(FILE *file, const struct interview *interview)
{
    const bool is_whole = interview->largest_number > 1.0;
    const double ceiling =
        isnan(interview->full_scale) ? interview->largest_number : interview->full_scale;
    const double white = is_whole ? 20.0 * log10(ceiling / interview->largest_number)
                                  : interview->seabed_db + HIGHLIGHTS_DB;
    const double black =
        (is_whole ? white - interview->ceiling_over_seabed_db : interview->seabed_db) - SHADOWS_DB;
    const bool is_suited =
        is_whole ? ceiling > 255.0 && !interview->is_decibel : interview->is_amplitude;
    if (is_suited && isfinite(black))
        fprintf(file,
                "grey: [%.0f dB, %.0f dB] # black and white of 8 bit images; without this line "
                "images have the swath's type, which detectors may not read\n",
                floor(black), ceil(white));
}

static void add_swaths(FILE *file, const struct interview *interview, const char *text)
{
    struct checked checked;
    read_checked(&checked, text);
    const double along_m = checked.along_m, wide_m = checked.last_m - checked.first_m;
    const struct init_options *options = interview->options;
    static const char *const sides[] = {"port", "starboard"};
    const char *answered =
        interview->has_nadir ? answer_about(interview, "input.geometry.side") : NULL;
    const char *first = answered ? answered : options->channel;
    const bool has_both = *interview->other_calibration || answered;
    if (has_both)
        fputs("splits: {train: 0.5, val: 0.5} # no swath is in two splits\n", file);
    else
        fputs("# splits: {train: 0.7, val: 0.3} # with more swaths; no swath is in two splits\n",
              file);
    fputs("labels: [yolo]\nswaths:\n", file);
    for (int i = 0; i < (has_both ? 2 : 1); i++) {
        const char *side = first && strcmp(first, sides[1]) == 0 ? sides[1 - i] : sides[i];
        add_path(file, "  - path: ", interview, options->image);
        fputc('\n', file);
        if (has_both && answered) {
            fprintf(file, "    set: {input.geometry.side: %s}\n", side);
        } else if (has_both) {
            fprintf(file, "    set: {input.channel: %s, ", side);
            add_text(file, "input.calibration: ",
                     last_part(i == 0 ? interview->calibration : interview->other_calibration));
            fputs("}\n", file);
        }
        fprintf(file,
                "    # avoid: [{along_track: [%.3g m, %.3g m], slant_range: [%.3g m, %.3g m]}] # "
                "boxes of contacts to keep away from\n",
                0.4 * along_m, 0.45 * along_m, checked.first_m + 0.3 * wide_m,
                checked.first_m + 0.5 * wide_m);
    }
}

/* Adds stones as high as the target, without targets. With bare seabed alone a detector would learn
 * that all bright things are targets. */
static void add_clutter(FILE *file, const char *text)
{
    struct checked checked;
    read_checked(&checked, text);
    fprintf(file,
            "clutter:\n"
            "  alone: 0.25 # this share of the images shows a stone and no target\n"
            "  number: 0 # no stones beside a target: they might hide it\n"
            "  objects:\n"
            "  - class: stone\n"
            "    object: {shape: ellipsoid, material: rock}\n"
            "    draw:\n"
            "      length: {log_uniform: [%.2g m, %.2g m]}\n"
            "      width: {of: length, uniform: [0.6, 0.95]}\n"
            "      height: {of: width, uniform: [0.5, 0.9]}\n",
            fmax(checked.top_m, 0.05), fmax(2.0 * checked.top_m, 0.1));
}

bool write_campaign(const struct interview *interview, const char *checked)
{
    char part[NAME + 8];
    FILE *file = begin(interview->campaign, part);
    if (!file)
        return false;
    fprintf(file,
            "# Make it: sonject campaign %s -o FOLDER. sonject help KEY explains keys.\n"
            "sonject_campaign: 1\n",
            last_part(interview->campaign));
    add_text(file, "scene: ", last_part(interview->scene));
    fputs(" # has all values that are not drawn\nimages: 500\n", file);
    add_chip(file, interview, checked);
    fputs("empty: 0.25 # this share of the images shows bare seabed\n"
          "visible: {highlight: 1.2 dB, shadow: -2.3 dB} # targets that nobody would see are drawn "
          "again\n",
          file);
    add_grey(file, interview);
    add_swaths(file, interview, checked);
    fprintf(file,
            "draw: # any key of a scene\n"
            "  objects[].heading: {uniform: [0 deg, 360 deg]}\n"
            "  objects[].burial.fraction: {uniform: [0, 0.3]}\n"
            "  objects[].level.over_seabed: {uniform: [%.0f dB, %.0f dB]} # of the echo's peak\n"
            "targets:\n",
            FAINTEST_DB, USUAL_LEVEL_DB);
    add_name(file, "  - class: ", interview);
    fputs("\n    object: {", file);
    if (interview->options->target) {
        add_target(file, interview, ", ");
        fputs("}\n", file);
    } else {
        fputs("shape: cylinder, material: steel}\n"
              "    draw: # put your targets' sizes here, or let sonject fit find those of your "
              "contacts\n"
              "      length: {log_uniform: [1.2 m, 1.9 m]}\n"
              "      diameter: {log_uniform: [0.4 m, 0.6 m]}\n",
              file);
    }
    add_clutter(file, checked);
    return finish(file, part, interview->campaign);
}
