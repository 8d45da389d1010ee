/* Labels that are one file: COCO's JSON, CSV, and YAML of published quantiles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/contact_reader.h"
#include "schema/keys.h"
#include "swath/recording.h"

/* ---- COCO. */

struct coco {
    struct contact_reader *reader;
    char file[TABLE_FILE_CAPACITY]; /* for messages */
    json_t *images, *categories;    /* entries of the document by the text of their id; owned */
};

/* Returns an id as a key: the text itself, or the digits of a whole number; NULL: it is neither. */
static const char *id_text(const json_t *id, char digits[24])
{
    if (!json_is_integer(id))
        return json_string_value(id);
    snprintf(digits, 24, "%lld", (long long)json_integer_value(id));
    return digits;
}

/* Indexes a list's entries by their ids. Each entry must have a text under the key. */
static sonject_status index_entries(struct coco *coco, const json_t *document, const char *list,
                                    const char *key, json_t **entries)
{
    struct report *report = coco->reader->report;
    size_t i;
    json_t *entry;
    char digits[24];
    *entries = json_object();
    CHECK_MEMORY(report, *entries, "contacts");
    if (!json_is_array(json_object_get(document, list)))
        return input_failure(report, coco->file, "%s: must be a list, as COCO has it", list);
    json_array_foreach(json_object_get(document, list), i, entry)
    {
        const char *id = id_text(json_object_get(entry, "id"), digits);
        if (!id || !json_is_string(json_object_get(entry, key)))
            return input_failure(report, coco->file, "%s[%zu]: needs an id and a %s", list, i, key);
        if (json_object_get(*entries, id))
            return input_failure(report, coco->file, "%s[%zu].id: an entry before has it, too",
                                 list, i);
        if (json_object_set(*entries, id, entry) != 0)
            return report_out_of_memory(report, "contacts");
    }
    return SONJECT_OK;
}

/* Reads a side of an image, pixels; 0 where the entry does not give it. Returns false for a value
 * that is no number of pixels. */
static bool read_side(const json_t *image, const char *key, uint64_t *pixels)
{
    const json_t *value = json_object_get(image, key);
    const json_int_t number = json_integer_value(value);
    *pixels = (uint64_t)number;
    return !value || (json_is_integer(value) && number > 0 && (uint64_t)number <= IMAGE_PIXELS_MAX);
}

/* Finds the class of an annotation. */
static sonject_status read_class(struct coco *coco, const char *place, const json_t *annotation,
                                 const char **name)
{
    char digits[24];
    const char *id = id_text(json_object_get(annotation, "category_id"), digits);
    const json_t *entry = id ? json_object_get(coco->categories, id) : NULL;
    if (!entry)
        return input_failure(coco->reader->report, place,
                             "category_id is of none of the categories");
    *name = member_text(entry, "name");
    return SONJECT_OK;
}

static sonject_status read_image(struct coco *coco, const char *place, const json_t *annotation,
                                 struct labelled_image *image)
{
    struct contact_reader *reader = coco->reader;
    char digits[24];
    const char *id = id_text(json_object_get(annotation, "image_id"), digits);
    const json_t *entry = id ? json_object_get(coco->images, id) : NULL;
    if (!entry)
        return input_failure(reader->report, place, "image_id is of none of the images");
    if (!read_side(entry, "width", &image->columns) || !read_side(entry, "height", &image->rows))
        return input_failure(reader->report, place,
                             "its image's width or height is not a whole number of pixels");
    return contact_reader_find_image(reader, place, member_text(entry, "file_name"),
                                     &image->number);
}

static sonject_status read_annotations(struct coco *coco, const json_t *annotations)
{
    struct contact_reader *reader = coco->reader;
    size_t i;
    json_t *annotation;
    if (!json_is_array(annotations))
        return input_failure(reader->report, coco->file,
                             "annotations: must be a list, as COCO has it");
    json_array_foreach(annotations, i, annotation)
    {
        char place[LABEL_PLACE];
        double sides[4];
        struct labelled_image image = {0, 0, 0, 0};
        const char *class_name = "";
        bool is_chosen;
        const json_t *box = json_object_get(annotation, "bbox");
        bool is_box = json_array_size(box) == 4;
        snprintf(place, sizeof place, "%s: annotations[%zu]", coco->file, i);
        for (size_t k = 0; is_box && k < 4; k++) {
            sides[k] = json_number_value(json_array_get(box, k));
            is_box = json_is_number(json_array_get(box, k));
        }
        if (!is_box)
            return input_failure(reader->report, place,
                                 "bbox must be four numbers of pixels, [x, y, width, height]");
        CHECK(read_class(coco, place, annotation, &class_name));
        CHECK(contact_reader_count(reader, class_name, &is_chosen));
        if (!is_chosen)
            continue;
        CHECK(read_image(coco, place, annotation, &image));
        CHECK(contact_reader_add(reader, place, &image,
                                 part_of_class(class_name, reader->choice->part),
                                 &(struct labelled_box){sides[0], sides[1], sides[2], sides[3]}));
    }
    return SONJECT_OK;
}

sonject_status contacts_of_coco(struct contact_reader *reader, const char *path)
{
    struct coco coco = {.reader = reader};
    json_t *document;
    text_excerpt(coco.file, sizeof coco.file, path);
    CHECK(json_document_read(reader->report, path, &document));
    sonject_status status = index_entries(&coco, document, "images", "file_name", &coco.images);
    THEN(status, index_entries(&coco, document, "categories", "name", &coco.categories));
    THEN(status, read_annotations(&coco, json_object_get(document, "annotations")));
    json_decref(coco.images);
    json_decref(coco.categories);
    json_decref(document);
    return status;
}

/* ---- CSV. */

enum column {
    COLUMN_IMAGE,
    COLUMN_ROW,
    COLUMN_COLUMN,
    COLUMN_ROWS,
    COLUMN_COLUMNS,
    COLUMN_PART,
    COLUMN_CLASS,
    COLUMN_SIDE,
    COLUMNS
};

/* Names of columns in a plain table, and in the library's own. In the latter, row and column are
 * those of a centre, and the fields of a box are empty where nothing of a contact is seen. */
static const char *const column_names[2][COLUMNS] = {
    {"image", "row", "column", "rows", "columns", "part", "class", "side"},
    {"image", "box_row", "box_column", "box_rows", "box_columns", "part", "class", "side"}};

struct contact_table {
    struct contact_reader *reader;
    char file[TABLE_FILE_CAPACITY]; /* for messages */
    const char *const *names;
    size_t fields[COLUMNS]; /* field of each column; TABLE_FIELDS_MAX: none */
};

static sonject_status take_names(struct contact_table *table, const struct table_row *row)
{
    struct report *report = table->reader->report;
    table->names = column_names[0];
    for (size_t i = 0; i < row->count; i++)
        if (strcmp(row->fields[i], column_names[1][COLUMN_ROW]) == 0)
            table->names = column_names[1];
    for (size_t k = 0; k < COLUMNS; k++) {
        table->fields[k] = TABLE_FIELDS_MAX;
        for (size_t i = 0; i < row->count; i++) {
            if (strcmp(row->fields[i], table->names[k]) != 0)
                continue;
            if (table->fields[k] != TABLE_FIELDS_MAX)
                return table_refuse(report, table->file, row->line, table->names[k],
                                    "two columns of this name; rename one");
            table->fields[k] = i;
        }
        if (k < COLUMN_PART && table->fields[k] == TABLE_FIELDS_MAX)
            return table_refuse(report, table->file, row->line, table->names[k],
                                "there is no such column; there must be image, row, column, rows, "
                                "columns, or those of sonject's contacts.csv");
    }
    return SONJECT_OK;
}

/* Returns a row's field; "" where there is no such column. */
static const char *field_of_column(const struct contact_table *table, const struct table_row *row,
                                   enum column column)
{
    const size_t field = table->fields[column];
    return field == TABLE_FIELDS_MAX ? "" : row->fields[field];
}

static sonject_status find_part(const struct contact_table *table, const struct table_row *row,
                                uint32_t *part)
{
    char excerpt[40];
    const char *word = field_of_column(table, row, COLUMN_PART);
    *part = part_of_class(field_of_column(table, row, COLUMN_CLASS), table->reader->choice->part);
    if (*word == 0)
        return SONJECT_OK;
    *part = strcmp(word, "both") == 0 ? LABELLED_BOTH : part_of_class(word, UINT32_MAX);
    if (*part == UINT32_MAX)
        return table_refuse(table->reader->report, table->file, row->line,
                            table->names[COLUMN_PART], "'%s' is not one of highlight, shadow, both",
                            text_excerpt(excerpt, sizeof excerpt, word));
    return SONJECT_OK;
}

static sonject_status take_row(void *user, const struct table_row *row)
{
    struct contact_table *table = user;
    struct contact_reader *reader = table->reader;
    struct labelled_image image = {0, 0, 0, 0};
    char place[LABEL_PLACE], excerpt[40];
    double sides[4];
    size_t empty = 0;
    uint32_t part;
    if (row->has_names)
        return take_names(table, row);
    for (enum column k = COLUMN_ROW; k <= COLUMN_COLUMNS; k++)
        empty += *field_of_column(table, row, k) == 0;
    if (empty == 4 && table->names == column_names[1])
        return SONJECT_OK;
    for (size_t k = 0; k < 4; k++) {
        const char *rest;
        const char *text = field_of_column(table, row, (enum column)(COLUMN_ROW + k));
        if (!text_to_number(text, &sides[k], &rest) || *rest)
            return table_refuse(reader->report, table->file, row->line,
                                table->names[COLUMN_ROW + k], "'%s' is not a number",
                                text_excerpt(excerpt, sizeof excerpt, text));
    }
    bool is_chosen;
    CHECK(contact_reader_count(reader, field_of_column(table, row, COLUMN_CLASS), &is_chosen));
    if (!is_chosen)
        return SONJECT_OK;
    const char *name = field_of_column(table, row, COLUMN_IMAGE);
    if (*name == '\'' && name[1] && strchr("=+-@", name[1]))
        name++; /* the quote keeps spreadsheets from taking a name for a formula */
    snprintf(place, sizeof place, "%s:%zu", table->file, row->line);
    CHECK(find_part(table, row, &part));
    const char *side = field_of_column(table, row, COLUMN_SIDE);
    image.side = strcmp(side, "port") == 0        ? RECORDED_PORT
                 : strcmp(side, "starboard") == 0 ? RECORDED_STARBOARD
                                                  : 0;
    if (*side && image.side == 0)
        return table_refuse(reader->report, table->file, row->line, table->names[COLUMN_SIDE],
                            "'%s' is neither port nor starboard",
                            text_excerpt(excerpt, sizeof excerpt, side));
    CHECK(contact_reader_find_image(reader, place, name, &image.number));
    return contact_reader_add(reader, place, &image, part,
                              &(struct labelled_box){sides[1], sides[0], sides[3], sides[2]});
}

sonject_status contacts_of_table(struct contact_reader *reader, const char *path)
{
    struct contact_table table = {.reader = reader};
    text_excerpt(table.file, sizeof table.file, path);
    return table_rows_read(reader->report, path, LABEL_BYTES_MAX, ";,", take_row, &table);
}

/* ---- Quantiles. */

#define LEVELS_MAX COUNT(((struct extent_quantiles *)0)->levels)

#define LIST      .kind = FIELD_SPECIAL /* lists are read once all are there */
#define STRUCTURE struct extent_quantiles
static const struct field quantile_fields[] = {
    {"highlight_along", "extents of highlights along track", LIST},
    {"highlight_range", "the same in slant range", LIST},
    {"shadow_along", "extents of shadows along track", LIST},
    {"shadow_range", "the same in slant range", LIST},
    {"quantiles", "shares of all contacts", LIST, REQUIRED},
    {"contacts", "how many they were read off", QUANTITY(contacts, NUMBER), WITHIN(1, 1e9),
     REQUIRED},
};
#undef STRUCTURE
#define EXTENTS 4

/* Reads a list of rising shares, or of lengths that do not fall. */
static sonject_status read_rising(struct reader *reader, const struct tree_node *node,
                                  bool are_shares, double *values)
{
    const double least = are_shares ? 0.0 : LENGTH_MIN_M;
    const double most = are_shares ? 1.0 : LENGTH_MAX_M;
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < node->count; i++) {
        const struct tree_node *entry = &node->entries[i].value;
        const size_t before = key_path_add_index(&reader->path, i);
        status = read_quantity(reader, entry, are_shares ? QUANTITY_NUMBER : QUANTITY_LENGTH,
                               &values[i]);
        if (status == SONJECT_OK && !(values[i] >= least && values[i] <= most))
            status = refuse_value(reader, entry, "must be from %g to %g%s, not %g", least, most,
                                  are_shares ? "" : " m", values[i]);
        if (status == SONJECT_OK && i > 0 &&
            (values[i] < values[i - 1] || (are_shares && values[i] == values[i - 1])))
            status = refuse_value(reader, entry, "must be above the one before, %g, not %g",
                                  values[i - 1], values[i]);
        key_path_shorten(&reader->path, before);
    }
    return status;
}

static sonject_status finish_quantiles(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    struct extent_quantiles *quantiles = structure;
    sonject_status status = SONJECT_OK;
    size_t told = 0;
    if (!is_given(node, quantile_fields[EXTENTS].key))
        return SONJECT_OK; /* the missing key is reported already */
    for (size_t i = EXTENTS + 1; status == SONJECT_OK && i-- > 0;) {
        const struct tree_entry *entry = tree_find(node, quantile_fields[i].key);
        if (!entry)
            continue;
        const struct tree_node *list = &entry->value;
        const bool is_levels = i == EXTENTS;
        const size_t before = key_path_add(&reader->path, entry->key);
        if (list->kind != TREE_LIST || list->count == 0 || list->count > LEVELS_MAX)
            status = refuse_value(reader, list, "must be a list of 1 to %zu numbers that rise",
                                  LEVELS_MAX);
        else if (!is_levels && list->count != quantiles->count)
            status = refuse_value(reader, list, "has %zu numbers, but there are %zu quantiles",
                                  list->count, quantiles->count);
        if (status == SONJECT_OK && is_levels)
            quantiles->count = list->count;
        THEN(status, read_rising(reader, list, is_levels,
                                 is_levels ? quantiles->levels : quantiles->extents_m[i]));
        told += !is_levels;
        key_path_shorten(&reader->path, before);
    }
    if (status == SONJECT_OK && told == 0 && node->count <= 2) /* else one key is unknown */
        return refuse_value(
            reader, node,
            "has no extents: add highlight_along, highlight_range, shadow_along or shadow_range");
    return status;
}

static const struct section quantile_section = {ROWS(quantile_fields), .finish = finish_quantiles};

sonject_status quantiles_of_file(struct contact_reader *reader, const char *path)
{
    struct extent_quantiles *quantiles = &reader->set->quantiles;
    struct tree tree;
    char *text;
    size_t bytes;
    CHECK(file_read_whole(reader->report, path, TREE_BYTES_MAX, &text, &bytes));
    for (size_t i = 0; i < EXTENTS; i++)
        for (size_t k = 0; k < LEVELS_MAX; k++)
            quantiles->extents_m[i][k] = NAN;
    struct mistakes mistakes = {0};
    tree_init(&tree, reader->report, path);
    tree.mistakes = &mistakes;
    reader->report->message[0] = 0;
    sonject_status status = tree_parse(&tree, text, bytes);
    free(text);
    struct reader keys = {.report = reader->report, .tree = &tree};
    THEN(status, read_section(&keys, &quantile_section, &tree.root, quantiles));
    status = mistakes_tell(&mistakes, reader->report, status);
    tree_clear(&tree);
    return status;
}
