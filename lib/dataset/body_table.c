/* Tables of measured bodies, which are drawn as whole rows. Columns are keys of objects. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign.h"
#include "schema/tables.h"

#define ROWS_MAX  10000
#define BYTES_MAX (4 * 1024 * 1024)

/* A table while it is read. */
struct body_reader {
    struct report *report;
    struct tree file; /* empty; gives the places of mistakes */
    struct distribution *distribution;
    const char *weight; /* column of weights; NULL: all rows weigh the same */
    size_t weight_place;
    size_t place[TABLE_FIELDS_MAX]; /* each key's place among the fields */
    char *units[TABLE_FIELDS_MAX];  /* unit of each key's numbers; NULL: none; owned */
};

static size_t column_of(const struct table_row *row, size_t field)
{
    return (size_t)(row->fields[field] - row->start) + 1;
}

/* Reads a column's name, "length [m]": the key and, if there is one, the unit. */
static sonject_status read_name(struct body_reader *reader, const struct table_row *row,
                                size_t field)
{
    struct body_table *table = reader->distribution->table;
    const struct tree_place place = {NULL, row->line, column_of(row, field)};
    char *name = row->fields[field];
    char *unit = strchr(name, '[');
    /* an index within a key, as in parts[0].length, is no unit */
    while (unit && unit > name && unit[-1] != ' ')
        unit = strchr(unit + 1, '[');
    const size_t length = strlen(name);
    if (unit && name[length - 1] != ']')
        return tree_failure(&reader->file, place, name, "has a unit without a closing ]");
    if (unit) {
        name[length - 1] = 0;
        *unit = 0;
        name[strcspn(name, " ")] = 0;
    }
    if (reader->weight && strcmp(name, reader->weight) == 0) {
        reader->weight_place = field;
        return unit ? tree_failure(&reader->file, place, name, "is a weight, which has no unit")
                    : SONJECT_OK;
    }
    CHECK(campaign_check_key(&reader->file, place, name, name, true));
    for (size_t i = 0; i < table->key_count; i++)
        if (strcmp(table->keys[i], name) == 0)
            return tree_failure(&reader->file, place, name, "two columns of this name; remove one");
    const size_t number = table->key_count++;
    reader->place[number] = field;
    table->keys[number] = copy_text(name);
    reader->units[number] = unit ? copy_text(unit + 1) : NULL;
    CHECK_MEMORY(reader->report, table->keys[number] && (!unit || reader->units[number]),
                 "a table");
    return SONJECT_OK;
}

static sonject_status read_names(struct body_reader *reader, const struct table_row *row)
{
    sonject_status status = SONJECT_OK;
    reader->weight_place = row->count;
    for (size_t i = 0; i < row->count && !reading_ends(status); i++) {
        const sonject_status found = read_name(reader, row, i);
        status = found == SONJECT_OK ? status : found;
    }
    const struct tree_place place = {NULL, row->line, 1};
    if (status == SONJECT_OK && reader->weight && reader->weight_place == row->count)
        return tree_failure(&reader->file, place, reader->weight,
                            "must be the column of weights, but no column has this name");
    return status;
}

/* Returns the field with the column's unit, for free(); NULL where memory is out. */
static char *make_cell(const char *field, const char *unit)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "%s%s%s", field, unit ? " " : "", unit ? unit : "");
    return growing_text_end(&text);
}

static sonject_status read_body(struct body_reader *reader, const struct table_row *row)
{
    struct distribution *distribution = reader->distribution;
    struct body_table *table = distribution->table;
    const size_t number = distribution->count;
    char text[24], excerpt[40];
    double weight = 1.0;
    const char *rest = "";
    if (number == ROWS_MAX)
        return table_refuse(reader->report, reader->file.file, row->line, "",
                            "more than %d rows; thin them out", ROWS_MAX);
    if (reader->weight) {
        const char *field = row->fields[reader->weight_place];
        const struct tree_place place = {NULL, row->line, column_of(row, reader->weight_place)};
        if (!text_to_number(field, &weight, &rest) || *rest || !(weight >= 0.0 && weight <= 1e9))
            return tree_failure(&reader->file, place, reader->weight,
                                "'%s' is not a number from 0 to 1e9",
                                text_excerpt(excerpt, sizeof excerpt, field));
    }
    CHECK(grow_list(reader->report, &distribution->texts, number, sizeof *distribution->texts,
                    "the campaign"));
    CHECK(grow_list(reader->report, &distribution->cumulative, number,
                    sizeof *distribution->cumulative, "the campaign"));
    CHECK(grow_list(reader->report, &table->cells, number, sizeof *table->cells, "the campaign"));
    distribution->cumulative[number] = weight;
    snprintf(text, sizeof text, "%zu", number);
    distribution->texts[number] = copy_text(text);
    table->cells[number] = allocate_array(table->key_count + 1, sizeof **table->cells);
    distribution->count++;
    CHECK_MEMORY(reader->report, distribution->texts[number] && table->cells[number], "a table");
    for (size_t i = 0; i < table->key_count; i++) {
        const char *field = row->fields[reader->place[i]];
        struct body_cell *cell = &table->cells[number][i];
        cell->place = (struct tree_place){NULL, row->line, column_of(row, reader->place[i])};
        cell->text = *field ? make_cell(field, reader->units[i]) : NULL;
        CHECK_MEMORY(reader->report, cell->text || !*field, "a table");
    }
    return SONJECT_OK;
}

static sonject_status read_row(void *user, const struct table_row *row)
{
    return row->has_names ? read_names(user, row) : read_body(user, row);
}

/* Turns weights into running sums of shares that add up to 1. */
static sonject_status finish_table(struct body_reader *reader)
{
    struct distribution *distribution = reader->distribution;
    const struct tree_place place = {NULL, 1, 1};
    double sum = 0.0;
    for (size_t i = 0; i < distribution->count; i++)
        distribution->cumulative[i] = sum += distribution->cumulative[i];
    if (!(sum > 0.0))
        return tree_failure(&reader->file, place, "",
                            distribution->count > 0 ? "weights are all 0" : "there are no rows");
    for (size_t i = 0; i < distribution->count; i++)
        distribution->cumulative[i] /= sum;
    return SONJECT_OK;
}

static sonject_status read_weight_name(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    struct body_reader *body = structure;
    body->weight = read_text(reader, node);
    return body->weight ? SONJECT_OK : SONJECT_ERROR_INPUT;
}

static sonject_status read_file_name(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    struct body_reader *body = structure;
    return read_existing_path(reader, node, &body->distribution->table->path);
}

static const struct field table_fields[] = {
    {"file", "file of the table", .kind = FIELD_SPECIAL, .read = read_file_name, REQUIRED},
    {"weight", "column of the rows' weights", .kind = FIELD_SPECIAL, .read = read_weight_name},
};
static const struct section table_section = {ROWS(table_fields)};

static sonject_status read_table(struct reader *reader, struct body_reader *body)
{
    struct body_table *table = body->distribution->table;
    char file[TABLE_FILE_CAPACITY];
    CHECK(file_hash(reader->report, table->path, table->hash));
    tree_init(&body->file, reader->report, text_excerpt(file, sizeof file, table->path));
    body->file.mistakes = reader->tree->mistakes;
    body->file.named_at = body->distribution->place;
    sonject_status status =
        table_rows_read(reader->report, table->path, BYTES_MAX, ";,", read_row, body);
    THEN(status, finish_table(body));
    for (size_t i = 0; i < TABLE_FIELDS_MAX; i++)
        free(body->units[i]);
    char *message = reader->report->message;
    if (status == SONJECT_ERROR_INPUT && *message && reader->tree->mistakes) {
        mistakes_add(reader->tree->mistakes, reader->tree, &body->distribution->place,
                     reader->path.text, message);
        *message = 0;
    }
    return status;
}

sonject_status body_table_read(struct reader *reader, const struct tree_node *node,
                               struct distribution *distribution)
{
    struct body_reader body = {.report = reader->report, .distribution = distribution};
    distribution->place = node->place;
    distribution->kind = DISTRIBUTION_CHOICE;
    distribution->key = copy_text("table");
    distribution->table = allocate_array(1, sizeof *distribution->table);
    CHECK_MEMORY(reader->report, distribution->key && distribution->table, "the campaign");
    CHECK(node->kind == TREE_SECTION ? read_section(reader, &table_section, node, &body)
                                     : read_file_name(reader, node, &body));
    return read_table(reader, &body);
}

const struct body_cell *body_table_row(const struct distribution *distribution, const char *text)
{
    uint64_t row = 0;
    text_to_count(text, &row);
    return distribution->table->cells[row];
}

void body_table_clear(struct body_table *table, size_t rows)
{
    for (size_t i = 0; table->cells && i < rows; i++) {
        for (size_t k = 0; table->cells[i] && k < table->key_count; k++)
            free(table->cells[i][k].text);
        free(table->cells[i]);
    }
    for (size_t k = 0; k < table->key_count; k++)
        free(table->keys[k]);
    free(table->cells);
    free(table->path);
    free(table);
}
