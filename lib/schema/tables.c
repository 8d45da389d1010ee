/* Tables of numbers, read line by line, and the checks of sound-speed profiles. */
#include "schema/tables.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/report.h"
#include "base/text.h"

/* A file while it is read row by row. */
struct row_reader {
    struct report *report;
    const char *file;    /* for messages */
    const char *choices; /* separators to choose from */
    char separator;      /* 0: a line is one field */
    size_t column_count; /* 0: the names have not been read */
    table_row_function *take;
    void *user;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Removes the blanks at both ends. */
static char *trim(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && is_blank(text[length - 1]))
        text[--length] = '\0';
    while (is_blank(*text))
        text++;
    return text;
}

/* Returns the end of the quotes that a field begins with, in which a doubled quote stands for one,
 * or the field itself if there are none or they do not end. */
static char *behind_quotes(char *field)
{
    char *end = field;
    while (*end == '"') {
        char *last = strchr(end + 1, '"');
        if (!last)
            return field;
        end = last + 1;
    }
    return end;
}

/* Removes the quotes of a trimmed field that is all in quotes. */
static char *unquote(char *field)
{
    char *end = behind_quotes(field);
    if (end == field || *end)
        return field;
    char *to = field;
    for (const char *from = field + 1; from < end - 1; from++) {
        *to++ = *from;
        from += *from == '"';
    }
    *to = '\0';
    return field;
}

/* Ends a line where a comment begins outside of quoted fields. */
static void cut_comment(char *line, const char *separators)
{
    for (;;) {
        line = behind_quotes(line + strspn(line, " \t"));
        while (*line && *line != '#' && (*line == ' ' || !strchr(separators, *line)))
            line++;
        if (*line == 0 || *line == '#')
            break;
        line++;
    }
    *line = '\0';
}

/* Cuts a trimmed line into fields, whose number may exceed TABLE_FIELDS_MAX. Fields may be in
 * quotes unless blanks separate them. */
static size_t split(char *line, char separator, char *fields[TABLE_FIELDS_MAX])
{
    size_t count = 0;
    for (char *end = line; end; count++) {
        char *start = line;
        if (separator && separator != ' ')
            line = behind_quotes(line + strspn(line, " "));
        end = separator == ' ' ? strpbrk(line, " \t") : separator ? strchr(line, separator) : NULL;
        if (end) {
            *end = '\0';
            line = end + 1;
            while (separator == ' ' && is_blank(*line))
                line++;
        }
        if (count < TABLE_FIELDS_MAX)
            fields[count] = separator == ' ' ? trim(start) : unquote(trim(start));
    }
    return count;
}

/* Returns the first choice that the line has, or a blank if that is a choice, or else 0. */
static char choose_separator(const char *line, const char *choices)
{
    while (*choices && *choices != ' ' && !strchr(line, *choices))
        choices++;
    return *choices;
}

/* Takes one line. line: ended by 0, with length bytes before. */
static sonject_status take_line(struct row_reader *reader, char *line, size_t length, size_t number)
{
    static const char not_text[] = "not UTF-8 text; is this a table?";
    char *fields[TABLE_FIELDS_MAX];
    const char *start = line;
    if (strlen(line) != length)
        return table_refuse(reader->report, reader->file, number, "", "%s", not_text);
    cut_comment(line, reader->choices);
    line = trim(line);
    if (!*line)
        return SONJECT_OK;
    for (char *c = line; *c; c++)
        if (*c == '\t')
            *c = ' ';
    if (!text_is_printable(line))
        return table_refuse(reader->report, reader->file, number, "", "%s", not_text);
    if (reader->column_count == 0)
        reader->separator = choose_separator(line, reader->choices);
    const size_t count = split(line, reader->separator, fields);
    if (count > TABLE_FIELDS_MAX)
        return table_refuse(reader->report, reader->file, number, "",
                            "more than %d columns; remove those that are not needed",
                            TABLE_FIELDS_MAX);
    if (reader->column_count > 0 && count != reader->column_count)
        return table_refuse(reader->report, reader->file, number, "",
                            "has %zu column%s, but %zu have names", count, count == 1 ? "" : "s",
                            reader->column_count);
    const struct table_row row = {number, reader->column_count == 0, start, fields, count};
    reader->column_count = count;
    return reader->take(reader->user, &row);
}

sonject_status table_rows_read(struct report *report, const char *path, size_t bytes_max,
                               const char *separators, table_row_function *take, void *user)
{
    char file[TABLE_FILE_CAPACITY];
    char *text = NULL;
    size_t bytes, number = 0;
    struct row_reader reader = {
        report, text_excerpt(file, sizeof file, path), separators, 0, 0, take, user};
    CHECK(file_read_whole(report, path, bytes_max, &text, &bytes));
    sonject_status status = SONJECT_OK;
    char *line = text;
    char *const end = text + bytes;
    if (bytes >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        line += 3;
    while (status == SONJECT_OK && line < end) {
        char *line_end = memchr(line, '\n', (size_t)(end - line));
        if (!line_end)
            line_end = end;
        *line_end = '\0';
        status = take_line(&reader, line, (size_t)(line_end - line), ++number);
        line = line_end + 1;
    }
    if (status == SONJECT_OK && reader.column_count == 0)
        status = input_failure(report, file, "there is nothing in it");
    free(text);
    return status;
}

sonject_status table_refuse(struct report *report, const char *file, size_t line,
                            const char *column, const char *format, ...)
{
    char what[240];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s:%zu: %s%s%s", file, line, column,
                          *column ? ": " : "", what);
}

/* ---- Tables of numbers. */

#define NUMBER_SEPARATORS ";, "

/* A table while its rows are read. */
struct table_reader {
    struct report *report;
    struct number_table *table;
    size_t place[TABLE_COLUMNS_MAX]; /* field of each known column; TABLE_FIELDS_MAX: not there */
};

/* Writes "height_m or depth_m, and sound_speed_mps". */
static void list_names(const struct table_format *format, char *text, size_t capacity)
{
    snprintf(text, capacity, "%s%s%s, and %s", format->names[0], format->names[1] ? " or " : "",
             format->names[1] ? format->names[1] : "", format->names[2]);
}

static sonject_status check_names(const struct table_reader *reader, size_t line)
{
    const struct table_format *format = reader->table->format;
    const char *file = reader->table->file;
    char names[120];
    const bool has_first = reader->place[0] != TABLE_FIELDS_MAX;
    const bool has_second = reader->place[1] != TABLE_FIELDS_MAX;
    if (has_first && has_second)
        return table_refuse(reader->report, file, line, "", "both %s and %s are there; rename one",
                            format->names[0], format->names[1]);
    if ((has_first || has_second) && reader->place[2] != TABLE_FIELDS_MAX)
        return SONJECT_OK;
    list_names(format, names, sizeof names);
    return table_refuse(reader->report, file, line, "",
                        "this line must name the columns, among them %s", names);
}

static sonject_status take_names(struct table_reader *reader, size_t line, char *const *fields,
                                 size_t count)
{
    struct number_table *table = reader->table;
    const struct table_format *format = table->format;
    for (int i = 0; i < TABLE_COLUMNS_MAX; i++) {
        reader->place[i] = TABLE_FIELDS_MAX;
        for (size_t j = 0; format->names[i] && j < count; j++) {
            if (strcmp(fields[j], format->names[i]) != 0)
                continue;
            if (reader->place[i] != TABLE_FIELDS_MAX)
                return table_refuse(reader->report, table->file, line, format->names[i],
                                    "two columns of this name; rename one");
            reader->place[i] = j;
        }
    }
    CHECK(check_names(reader, line));
    for (int i = 0; i < TABLE_COLUMNS_MAX; i++) {
        if (reader->place[i] == TABLE_FIELDS_MAX)
            continue;
        table->values[i] = allocate_array(format->samples_max, sizeof *table->values[i]);
        CHECK_MEMORY(reader->report, table->values[i], "a table");
    }
    return SONJECT_OK;
}

static sonject_status take_row(void *user, const struct table_row *row)
{
    struct table_reader *reader = user;
    struct number_table *table = reader->table;
    table->last_line = row->line;
    if (row->has_names)
        return take_names(reader, row->line, row->fields, row->count);
    if (table->count == table->format->samples_max)
        return table_refuse(reader->report, table->file, row->line, "",
                            "more than %zu samples; thin them out", table->format->samples_max);
    for (int i = 0; i < TABLE_COLUMNS_MAX; i++) {
        char excerpt[40];
        const char *rest;
        const char *text = table->values[i] ? row->fields[reader->place[i]] : NULL;
        if (text && (!text_to_number(text, &table->values[i][table->count], &rest) || *rest))
            return table_refuse(reader->report, table->file, row->line, table->format->names[i],
                                "'%s' is not a number",
                                text_excerpt(excerpt, sizeof excerpt, text));
    }
    table->lines[table->count++] = row->line;
    return SONJECT_OK;
}

sonject_status number_table_refuse(const struct number_table *table, struct report *report,
                                   size_t sample, size_t column, const char *what)
{
    return table_refuse(report, table->file,
                        sample < table->count ? table->lines[sample] : table->last_line,
                        table->format->names[column], "%s", what);
}

static sonject_status check_samples(const struct number_table *table, struct report *report)
{
    const struct table_format *format = table->format;
    const size_t first = table->values[0] ? 0 : 1;
    const double *positions = table->values[first];
    char what[120];
    if (table->count < format->samples_min) {
        snprintf(what, sizeof what, "must have %zu...%zu samples, not %zu", format->samples_min,
                 format->samples_max, table->count);
        return number_table_refuse(table, report, table->count, first, what);
    }
    for (size_t i = 0; i < table->count; i++) {
        for (size_t k = 0; k < TABLE_COLUMNS_MAX; k++) {
            const double value = table->values[k] ? table->values[k][i] : 0.0;
            if (format->most[k] == 0.0 || fabs(value) <= format->most[k])
                continue;
            snprintf(what, sizeof what, "must be within +-%g, not %g", format->most[k], value);
            return number_table_refuse(table, report, i, k, what);
        }
        if (format->rises && i > 0 && !(positions[i] > positions[i - 1])) {
            snprintf(what, sizeof what, "must be above that of the sample before, %g, not %g",
                     positions[i - 1], positions[i]);
            return number_table_refuse(table, report, i, first, what);
        }
    }
    return SONJECT_OK;
}

static sonject_status take_array(struct table_reader *reader, const struct number_array *array)
{
    struct number_table *table = reader->table;
    char *fields[TABLE_FIELDS_MAX];
    char *names = copy_text(array->columns);
    CHECK_MEMORY(reader->report, names, "a table");
    char *line = trim(names);
    const size_t count = split(line, choose_separator(line, NUMBER_SEPARATORS), fields);
    sonject_status status = SONJECT_OK;
    if (count != array->column_count || count > TABLE_FIELDS_MAX)
        status = table_refuse(reader->report, table->file, 0, "",
                              "as many names as columns are needed, up to %d", TABLE_FIELDS_MAX);
    THEN(status, take_names(reader, 0, fields, count));
    free(names);
    CHECK(status);
    if (array->rows > table->format->samples_max)
        return table_refuse(reader->report, table->file, 0, "", "too many samples; thin them out");
    for (size_t row = 0; row < array->rows; row++) {
        const double *values = array->values + row * array->column_count;
        for (int i = 0; i < TABLE_COLUMNS_MAX; i++)
            if (table->values[i])
                table->values[i][row] = values[reader->place[i]];
        table->lines[row] = table->last_line = row + 1;
        table->count = row + 1;
    }
    return SONJECT_OK;
}

sonject_status number_table_read(struct report *report, const char *path,
                                 const struct number_array *array,
                                 const struct table_format *format, struct number_table *table)
{
    struct table_reader reader = {report, table, {0}};
    memset(table, 0, sizeof *table);
    table->format = format;
    text_excerpt(table->file, sizeof table->file, array ? array->name : path);
    table->lines = allocate_array(format->samples_max, sizeof *table->lines);
    CHECK_MEMORY(report, table->lines, "a table");
    sonject_status status = array ? take_array(&reader, array)
                                  : table_rows_read(report, path, format->bytes_max,
                                                    NUMBER_SEPARATORS, take_row, &reader);
    THEN(status, check_samples(table, report));
    if (status != SONJECT_OK)
        number_table_clear(table);
    return status;
}

void number_table_clear(struct number_table *table)
{
    for (int i = 0; i < TABLE_COLUMNS_MAX; i++)
        free(table->values[i]);
    free(table->lines);
    memset(table, 0, sizeof *table);
}

/* ---- Sound-speed profiles. */

enum {
    HEIGHT,
    DEPTH,
    SPEED
};

static const struct table_format profile_format = {
    .names = {"height_m", "depth_m", "sound_speed_mps"},
    .samples_max = PROFILE_SAMPLES_MAX,
    .bytes_max = PROFILE_BYTES_MAX};

sonject_status profile_table_read(struct report *report, const char *path,
                                  const struct number_array *array, struct profile_table *table)
{
    struct number_table numbers;
    struct profile_fault fault;
    sonject_status status = SONJECT_OK;
    CHECK(number_table_read(report, path, array, &profile_format, &numbers));
    const int position = numbers.values[DEPTH] ? DEPTH : HEIGHT;
    *table = (struct profile_table){numbers.values[position], numbers.values[SPEED], numbers.count,
                                    position == DEPTH};
    numbers.values[position] = numbers.values[SPEED] = NULL;
    if (!profile_table_is_good(table, &fault))
        status = number_table_refuse(&numbers, report, fault.sample,
                                     (size_t)(fault.is_speed ? SPEED : position), fault.what);
    number_table_clear(&numbers);
    if (status != SONJECT_OK)
        profile_table_clear(table);
    return status;
}

static bool is_within(struct profile_fault *fault, double value, double least, double most,
                      const char *unit)
{
    snprintf(fault->what, sizeof fault->what, "must be %g...%g%s, not %g", least, most, unit,
             value);
    return value >= least && value <= most;
}

/* Returns whether sample i >= 1 goes on in the direction of the first two. */
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
