#include "io/profile_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/ranges.h"
#include "base/text.h"
#include "medium/profile.h"

#define COLUMNS_MAX 64

enum {
    HEIGHT,
    DEPTH,
    SPEED,
    KNOWN_COLUMNS
};

static const char *const column_names[KNOWN_COLUMNS] = {"height_m", "depth_m", "sound_speed_mps"};

/* A file on its way into a table. */
struct table_reader {
    struct report *report;
    char file[400]; /* for messages */
    struct profile_table *table;
    size_t line;
    char separator;
    size_t column_count;         /* 0: the names are still to come */
    size_t place[KNOWN_COLUMNS]; /* of each known column; COLUMNS_MAX: not there */
    size_t sample_lines[PROFILE_SAMPLES_MAX];
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static sonject_status refuse_line(const struct table_reader *reader, const char *column,
                                  const char *what)
{
    return report_failure(reader->report, SONJECT_ERROR_INPUT, "%s:%zu: %s%s%s", reader->file,
                          reader->line, column, *column ? ": " : "", what);
}

static char *trim(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && is_blank(text[length - 1]))
        text[--length] = '\0';
    while (is_blank(*text))
        text++;
    return text;
}

/* Cuts a trimmed line into fields, whose number may exceed COLUMNS_MAX. */
static size_t split(char *line, char separator, char *fields[COLUMNS_MAX])
{
    size_t count = 0;
    for (char *end = line; end; count++) {
        char *start = line;
        end = separator == ' ' ? strpbrk(line, " \t") : strchr(line, separator);
        if (end) {
            *end = '\0';
            line = end + 1;
            while (separator == ' ' && is_blank(*line))
                line++;
        }
        if (count < COLUMNS_MAX)
            fields[count] = trim(start);
    }
    return count;
}

static sonject_status take_names(struct table_reader *reader, char *line)
{
    char *fields[COLUMNS_MAX];
    reader->separator = strchr(line, ';') ? ';' : strchr(line, ',') ? ',' : ' ';
    reader->column_count = split(line, reader->separator, fields);
    if (reader->column_count > COLUMNS_MAX)
        return refuse_line(reader, "", "more than 64 columns; remove those that are not needed");
    for (int i = 0; i < KNOWN_COLUMNS; i++) {
        reader->place[i] = COLUMNS_MAX;
        for (size_t j = 0; j < reader->column_count; j++) {
            if (strcmp(fields[j], column_names[i]) != 0)
                continue;
            if (reader->place[i] != COLUMNS_MAX)
                return refuse_line(reader, column_names[i], "two columns of this name; rename one");
            reader->place[i] = j;
        }
    }
    const bool has_height = reader->place[HEIGHT] != COLUMNS_MAX;
    const bool has_depth = reader->place[DEPTH] != COLUMNS_MAX;
    if (has_height && has_depth)
        return refuse_line(reader, "", "both height_m and depth_m are there; rename one");
    if ((!has_height && !has_depth) || reader->place[SPEED] == COLUMNS_MAX)
        return refuse_line(reader, "",
                           "this line must name the columns, among them height_m or depth_m, and "
                           "sound_speed_mps");
    reader->table->is_depth = has_depth;
    return SONJECT_OK;
}

static sonject_status take_number(struct table_reader *reader, int column,
                                  char *const fields[COLUMNS_MAX], double *number)
{
    char excerpt[40], what[100];
    const char *text = fields[reader->place[column]];
    const char *rest;
    if (text_to_number(text, number, &rest) && *rest == '\0')
        return SONJECT_OK;
    snprintf(what, sizeof what, "'%s' is not a number",
             text_excerpt(excerpt, sizeof excerpt, text));
    return refuse_line(reader, column_names[column], what);
}

static sonject_status take_sample(struct table_reader *reader, char *line)
{
    struct profile_table *table = reader->table;
    char *fields[COLUMNS_MAX];
    const size_t count = split(line, reader->separator, fields);
    if (count != reader->column_count) {
        char what[100];
        snprintf(what, sizeof what, "has %zu column%s, but %zu have names", count,
                 count == 1 ? "" : "s", reader->column_count);
        return refuse_line(reader, "", what);
    }
    if (table->count == PROFILE_SAMPLES_MAX)
        return refuse_line(reader, "", "more than 4096 samples; thin them out");
    sonject_status status = take_number(reader, table->is_depth ? DEPTH : HEIGHT, fields,
                                        &table->positions_m[table->count]);
    if (status == SONJECT_OK)
        status = take_number(reader, SPEED, fields, &table->speeds_mps[table->count]);
    reader->sample_lines[table->count++] = reader->line;
    return status;
}

/* line: ended by 0, length bytes before that. */
static sonject_status take_line(struct table_reader *reader, char *line, size_t length)
{
    static const char not_text[] = "not UTF-8 text; is this a table?";
    reader->line++;
    if (strlen(line) != length)
        return refuse_line(reader, "", not_text);
    line[strcspn(line, "#")] = '\0';
    line = trim(line);
    if (!*line)
        return SONJECT_OK;
    for (char *c = line; *c; c++)
        if (*c == '\t')
            *c = ' ';
    if (!text_is_printable(line))
        return refuse_line(reader, "", not_text);
    return reader->column_count == 0 ? take_names(reader, line) : take_sample(reader, line);
}

static sonject_status take_text(struct table_reader *reader, char *text, size_t bytes)
{
    sonject_status status = SONJECT_OK;
    char *const end = text + bytes;
    if (bytes >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        text += 3;
    while (status == SONJECT_OK && text < end) {
        char *line_end = memchr(text, '\n', (size_t)(end - text));
        if (!line_end)
            line_end = end;
        *line_end = '\0';
        status = take_line(reader, text, (size_t)(line_end - text));
        text = line_end + 1;
    }
    return status;
}

/* All that was read, once it is there. */
static sonject_status check_samples(struct table_reader *reader)
{
    const struct profile_table *table = reader->table;
    struct profile_fault fault;
    if (reader->column_count == 0)
        return report_failure(reader->report, SONJECT_ERROR_INPUT, "%s: there is nothing in it",
                              reader->file);
    if (profile_table_is_good(table, &fault))
        return SONJECT_OK;
    if (fault.sample < table->count)
        reader->line = reader->sample_lines[fault.sample];
    return refuse_line(reader,
                       column_names[fault.is_speed    ? SPEED
                                    : table->is_depth ? DEPTH
                                                      : HEIGHT],
                       fault.what);
}

sonject_status profile_table_read(struct report *report, const char *path,
                                  struct profile_table *table)
{
    char *text = NULL;
    size_t bytes;
    struct table_reader *reader = allocate_array(1, sizeof *reader);
    table->positions_m = allocate_array(PROFILE_SAMPLES_MAX, sizeof *table->positions_m);
    table->speeds_mps = allocate_array(PROFILE_SAMPLES_MAX, sizeof *table->speeds_mps);
    sonject_status status = reader && table->positions_m && table->speeds_mps
                                ? SONJECT_OK
                                : report_out_of_memory(report, "a sound-speed profile");
    if (status == SONJECT_OK)
        status = file_read_whole(report, path, PROFILE_BYTES_MAX, &text, &bytes);
    if (status == SONJECT_OK) {
        reader->report = report;
        reader->table = table;
        text_excerpt(reader->file, sizeof reader->file, path);
        status = take_text(reader, text, bytes);
    }
    if (status == SONJECT_OK)
        status = check_samples(reader);
    free(text);
    free(reader);
    if (status != SONJECT_OK)
        profile_table_clear(table);
    return status;
}

/* What a range check says, without the value's name. */
static bool is_within(struct profile_fault *fault, double value, double least, double most,
                      const char *unit)
{
    struct report report = {{0}, NULL, NULL};
    struct check check = {&report, NULL, SONJECT_OK};
    check_within(&check, "it", value, least, most, unit);
    if (check.status != SONJECT_OK)
        snprintf(fault->what, sizeof fault->what, "%.190s", report.message + 3);
    return check.status == SONJECT_OK;
}

/* Whether sample i >= 1 goes on in the direction of the first two. */
static bool goes_on(const struct profile_table *table, size_t i, struct profile_fault *fault)
{
    const double *position = table->positions_m;
    const double step = position[i] - position[i - 1];
    const bool rises = position[1] > position[0];
    if (fabs(step) >= WATER_HEIGHT_STEP_MIN_M && (step > 0.0) == rises)
        return true;
    snprintf(fault->what, sizeof fault->what,
             "must %s from one to the next by at least %g m; %.9g follows %.9g",
             i == 1  ? "rise or fall"
             : rises ? "go on rising"
                     : "go on falling",
             WATER_HEIGHT_STEP_MIN_M, position[i], position[i - 1]);
    return false;
}

bool profile_table_is_good(const struct profile_table *table, struct profile_fault *fault)
{
    fault->is_speed = false;
    for (size_t i = 0; i < table->count; i++) {
        fault->sample = i;
        if (!is_within(fault, table->positions_m[i], table->is_depth ? 0.0 : -1e6, 1e6, " m"))
            return false;
        if (i > 0 && !goes_on(table, i, fault))
            return false;
        if (!is_within(fault, table->speeds_mps[i], WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS,
                       " m/s")) {
            fault->is_speed = true;
            return false;
        }
    }
    fault->sample = table->count;
    snprintf(fault->what, sizeof fault->what, "a profile needs at least two samples, not %zu",
             table->count);
    return table->count >= 2;
}

static void reverse(double *values, size_t count)
{
    for (size_t i = 0; i < count / 2; i++) {
        const double value = values[i];
        values[i] = values[count - 1 - i];
        values[count - 1 - i] = value;
    }
}

void profile_table_to_heights(struct profile_table *table, double depth_m)
{
    for (size_t i = 0; table->is_depth && i < table->count; i++)
        table->positions_m[i] = depth_m - table->positions_m[i];
    table->is_depth = false;
    if (table->positions_m[0] < table->positions_m[1])
        return;
    reverse(table->positions_m, table->count);
    reverse(table->speeds_mps, table->count);
}

void profile_table_clear(struct profile_table *table)
{
    free(table->positions_m);
    free(table->speeds_mps);
    memset(table, 0, sizeof *table);
}
