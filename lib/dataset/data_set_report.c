/* The page of a data set: counts, histograms of drawn values and of results, and images. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"
#include "dataset/run.h"

#define SERIES_MAX 64    /* names; the page leaves out later ones */
#define IMAGES_MAX 20000 /* images shown; of more, every second, third, ... is taken */
#define DIGITS     6
#define CHIPS_MAX  (64 * SHEET_CELLS) /* images drawn because browsers cannot show them */
#define CUT_MANY   0.25               /* share of cut images above which a note tells */

/* Values of one name, in one unit. */
struct series {
    char name[80], unit[16];
    double *values; /* owned */
    size_t count;
};

/* Numbers that images were made with, and their possible sources, both as truth names them. */
static const char *const number_names[] = {"transfer", "noise_floor_db", "looks", "altitude_m",
                                           "seabed_lambert_db"};
static const uint32_t sources[] = {SONJECT_SOURCE_SCENE,    SONJECT_SOURCE_CALIBRATION,
                                   SONJECT_SOURCE_PATCH,    SONJECT_SOURCE_DEFAULT,
                                   SONJECT_SOURCE_FALLBACK, SONJECT_SOURCE_FILE};

struct statistics_page {
    const struct data_set *set;
    struct series series[SERIES_MAX];
    size_t series_count;
    uint64_t (*counts)[CLASSES_MAX]; /* numbers of objects, splits x classes; owned */
    uint64_t empty[CAMPAIGN_SPLITS_MAX], clutter_alone[CAMPAIGN_SPLITS_MAX];
    json_t *classes; /* all classes, those in labels first; owned */
    uint64_t every;  /* the every-th image is taken */
    uint64_t drawn_anew, difficult, clipped, unseen, cut;
    uint64_t sources[COUNT(number_names)][COUNT(sources)]; /* numbers of images */
    json_t *rows;  /* rows of the images that are taken; owned */
    json_t *sheet; /* owned */
    uint32_t cell_height;
    uint64_t chips[CHIPS_MAX]; /* images drawn for the page */
    uint32_t chip_count;
};

/* Returns a histogram of a series. */
static json_t *histogram_document(const struct series *series)
{
    double low = series->values[0];
    double high = series->values[0];
    for (size_t i = 1; i < series->count; i++) {
        low = fmin(low, series->values[i]);
        high = fmax(high, series->values[i]);
    }
    return JSON_OBJECT({"name", json_string(series->name)}, {"unit", json_string(series->unit)},
                       {"low", json_number(low)}, {"high", json_number(high)},
                       {"bins", histogram_counts(series->values, series->count, low, high)});
}

static sonject_status add_value(struct statistics_page *page, const char *name, const char *unit,
                                double value)
{
    struct series *series = page->series;
    struct series *end = series + page->series_count;
    while (series < end && (strcmp(series->name, name) != 0 || strcmp(series->unit, unit) != 0))
        series++;
    if (series == end) {
        if (page->series_count == SERIES_MAX || strlen(name) >= sizeof series->name ||
            strlen(unit) >= sizeof series->unit)
            return SONJECT_OK;
        strcpy(series->name, name);
        strcpy(series->unit, unit);
        page->series_count++;
    }
    CHECK(grow_list(page->set->report, &series->values, series->count, sizeof *series->values,
                    "the report"));
    series->values[series->count++] = value;
    return SONJECT_OK;
}

/* Adds a value that was set, if it is a number: "objects[0].heading=35 deg". Values of all objects
 * count together. The chip's place and seed are left out, since they tell nothing of the image. */
static sonject_status add_set_value(struct statistics_page *page, const char *text)
{
    char key[80];
    double value;
    const char *rest;
    const size_t length = strcspn(text, "=");
    if (length >= sizeof key || !text[length])
        return SONJECT_OK;
    memcpy(key, text, length);
    key[length] = 0;
    char *bracket = strncmp(key, "objects[", 8) == 0 ? strchr(key, ']') : NULL;
    if (bracket)
        memmove(key + 8, bracket, strlen(bracket) + 1);
    if (strncmp(key, "patch", 5) == 0 || strcmp(key, "injection.seed") == 0 ||
        strcmp(key, "input.path") == 0 || !text_to_number(text + length + 1, &value, &rest))
        return SONJECT_OK;
    return add_value(page, key, rest + strspn(rest, " "), value);
}

static sonject_status add_object(struct statistics_page *page, size_t split, const json_t *object,
                                 bool is_taken)
{
    static const struct {
        const char *name, *unit, *key;
    } values[] = {{"slant range of objects", "m", "slant_range_m"},
                  {"grazing angle of objects", "deg", "grazing_deg"},
                  {"burial of objects", "m", "burial_m"},
                  {"target strength of objects", "dB", "target_strength_db"},
                  {"contrast of highlights", "dB", "highlight_contrast_db"},
                  {"contrast of shadows", "dB", "shadow_contrast_db"},
                  {"visibility of highlights", "dB", "highlight_visibility_db"},
                  {"visibility of shadows", "dB", "shadow_visibility_db"},
                  {"clipped share of highlights", "", "highlight_clipped"},
                  {"pixels of highlights", "", "highlight_pixels"},
                  {"pixels of shadows", "", "shadow_pixels"}};
    const char *name = member_text(object, "class");
    size_t i = 0;
    while (i < json_array_size(page->classes) &&
           strcmp(json_string_value(json_array_get(page->classes, i)), name) != 0)
        i++;
    if (i == json_array_size(page->classes) && i < CLASSES_MAX) /* a class without labels */
        json_append(&page->classes, json_text(name));
    if (i < CLASSES_MAX)
        page->counts[split][i]++;
    page->unseen += json_is_false(json_object_get(object, "visible"));
    page->clipped += json_number_value(json_object_get(object, "highlight_clipped")) > CLIPPED_MUCH;
    for (i = 0; is_taken && i < COUNT(values); i++) {
        const json_t *value = json_object_get(object, values[i].key);
        if (json_is_number(value))
            CHECK(add_value(page, values[i].name, values[i].unit, json_number_value(value)));
    }
    return SONJECT_OK;
}

/* The members of an object's truth that the page shows. */
static const struct {
    const char *of, *key; /* of: section of the truth; "": the object's own member */
} row_members[] = {{"", "class"},
                   {"", "shape"},
                   {"", "visible"},
                   {"", "slant_range_m"},
                   {"level", "over_seabed_db"},
                   {"", "highlight_visibility_db"},
                   {"", "shadow_visibility_db"},
                   {"box", "row"},
                   {"box", "column"},
                   {"box", "rows"},
                   {"box", "columns"}};

static json_t *object_row(const json_t *object)
{
    json_t *row = json_array();
    for (size_t i = 0; i < COUNT(row_members); i++) {
        const char *of = row_members[i].of;
        json_t *value =
            json_object_get(*of ? json_object_get(object, of) : object, row_members[i].key);
        json_append(&row, value ? json_incref(value) : json_null());
    }
    return row;
}

/* Adds an image's row: number, split, ending of the file; why the first draw was given up; the
 * objects; height and width to draw the image with. */
static sonject_status add_row(struct statistics_page *page, size_t split, uint64_t id,
                              const json_t *record, const json_t *objects)
{
    size_t i;
    const json_t *object;
    uint32_t sides[2];
    CHECK(sheet_image_sides(page->set, split, record, sides));
    const char *ending = strrchr(member_text(record, "image"), '.');
    const json_t *anew = json_object_get(record, "drawn_anew");
    json_t *row = json_array();
    json_t *list = json_array();
    json_array_foreach(objects, i, object)
    {
        json_append(&list, object_row(object));
    }
    json_append(&row, json_count(id));
    json_append(&row, json_count(split));
    json_append(&row, json_text(ending ? ending : ""));
    json_append(&row, anew ? json_text(member_text(anew, "because")) : json_null());
    json_append(&row, list);
    json_append(&row, json_count(sides[0]));
    json_append(&row, json_count(sides[1]));
    json_append(&page->rows, row);
    page->cell_height = sides[0] > page->cell_height ? sides[0] : page->cell_height;
    if (ending && strcmp(ending, ".tif") == 0 && page->chip_count < CHIPS_MAX)
        page->chips[page->chip_count++] = id;
    return SONJECT_OK;
}

static void add_sources(struct statistics_page *page, const json_t *numbers)
{
    for (size_t i = 0; i < COUNT(number_names); i++)
        for (size_t k = 0; k < COUNT(sources); k++)
            page->sources[i][k] +=
                strcmp(member_text(json_object_get(numbers, number_names[i]), "from"),
                       source_word(sources[k])) == 0;
}

static sonject_status add_image(struct statistics_page *page, size_t split, uint64_t id)
{
    const struct data_set *set = page->set;
    char path[PATH_CAPACITY], name[IMAGE_NAME_CAPACITY];
    json_t *record = NULL;
    json_t *truth = NULL;
    const bool is_taken = id % page->every == 0;
    size_t i;
    const json_t *entry;
    CHECK(path_in(set->report, path, set->folder, "%s/%s", set->split_names[split],
                  image_file_name(id, OUTPUT_TRUTH, NULL, name)));
    sonject_status status = data_set_record(set, split, id, &record);
    THEN(status, json_document_read(set->report, path, &truth));
    json_array_foreach(json_object_get(record, "set"), i, entry)
    {
        if (is_taken && json_is_string(entry))
            THEN(status, add_set_value(page, json_string_value(entry)));
    }
    page->drawn_anew += json_object_get(record, "drawn_anew") != NULL;
    bool is_cut = false;
    json_array_foreach(json_object_get(record, "annotations"), i, entry)
    {
        page->difficult += json_is_true(json_object_get(entry, "difficult"));
        is_cut = is_cut || json_is_true(json_object_get(entry, "truncated"));
    }
    page->cut += is_cut;
    add_sources(page, json_object_get(truth, "numbers"));
    const json_t *objects = json_object_get(truth, "objects");
    if (json_array_size(objects) == 0)
        page->empty[split]++;
    else if (json_is_null(json_object_get(record, "target")))
        page->clutter_alone[split]++;
    json_array_foreach(objects, i, entry)
    {
        THEN(status, add_object(page, split, entry, is_taken));
    }
    if (status == SONJECT_OK && (is_taken || contact_sheet_shows(set, id)))
        status = add_row(page, split, id, record, objects);
    json_decref(record);
    json_decref(truth);
    return status;
}

/* Returns each split with its images, and its objects of each class. */
static json_t *splits_document(const struct statistics_page *page)
{
    const struct data_set *set = page->set;
    const size_t classes = json_array_size(page->classes);
    json_t *splits = json_array();
    for (size_t i = 0; i < set->split_count; i++)
        json_append(&splits, JSON_OBJECT({"name", json_string(set->split_names[i])},
                                         {"images", json_count(set->split_images[i])},
                                         {"empty", json_count(page->empty[i])},
                                         {"clutter_alone", json_count(page->clutter_alone[i])},
                                         {"objects", json_counts(page->counts[i], classes)}));
    return splits;
}

/* Returns for each number how many images have it from each source. */
static json_t *numbers_document(const struct statistics_page *page)
{
    json_t *numbers = json_object();
    for (size_t i = 0; i < COUNT(number_names); i++) {
        json_t *from = json_object();
        for (size_t k = 0; k < COUNT(sources); k++)
            json_add(&from, source_word(sources[k]), json_count(page->sources[i][k]));
        json_add(&numbers, number_names[i], from);
    }
    return numbers;
}

/* Returns the page's data. Takes over page->rows and page->sheet. */
static json_t *page_document(struct statistics_page *page)
{
    static const char *const kept[] = {"sonject", "hash", "swaths", "empty", "clutter_alone"};
    json_t *columns = json_array();
    json_t *histograms = json_array();
    for (size_t i = 0; i < COUNT(row_members); i++)
        json_append(&columns, json_string(row_members[i].key));
    for (size_t i = 0; i < page->series_count; i++)
        json_append(&histograms, histogram_document(&page->series[i]));
    json_t *document = JSON_OBJECT(
        {"images", json_count(page->set->images)}, JSON_COUNT(page, every),
        {"splits", splits_document(page)}, {"numbers", numbers_document(page)},
        JSON_COUNT(page, drawn_anew), JSON_COUNT(page, difficult), JSON_COUNT(page, unseen),
        JSON_COUNT(page, clipped), JSON_COUNT(page, cut), {"sheet", page->sheet},
        {"histograms", histograms}, {"columns", columns}, {"classes", json_incref(page->classes)},
        {"rows", page->rows}, {"chips", json_count(page->chip_count)});
    page->rows = page->sheet = NULL;
    for (size_t i = 0; i < COUNT(kept); i++)
        json_add(&document, kept[i], json_incref(json_object_get(page->set->head, kept[i])));
    return document;
}

/* Draws chips that browsers can show, sheet after sheet. */
static sonject_status write_chips(const struct statistics_page *page)
{
    const struct data_set *set = page->set;
    char name[PATH_CAPACITY];
    CHECK(path_in(set->report, name, set->folder, CHIPS_FOLDER));
    if (page->chip_count > 0)
        CHECK(folder_make(set->report, name));
    for (uint32_t i = 0; i < page->chip_count; i += SHEET_CELLS) {
        const uint32_t left = page->chip_count - i;
        snprintf(name, sizeof name, CHIPS_FOLDER "/%u.png", (unsigned)(i / SHEET_CELLS));
        CHECK(write_sheet(set, name, page->chips + i, left < SHEET_CELLS ? left : SHEET_CELLS,
                          page->cell_height));
    }
    return SONJECT_OK;
}

sonject_status write_report_page(const struct data_set *set)
{
    char path[PATH_CAPACITY];
    struct statistics_page *page = allocate_array(1, sizeof *page);
    CHECK_MEMORY(set->report, page, "the report");
    page->set = set;
    page->every = (set->images + IMAGES_MAX - 1) / IMAGES_MAX;
    page->classes = json_copy(json_object_get(set->head, "classes"));
    page->rows = json_array();
    page->counts = allocate_array(set->split_count, sizeof *page->counts);
    sonject_status status =
        page->counts ? SONJECT_OK : report_out_of_memory(set->report, "the report");
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++)
        for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[i]; k++)
            status = add_image(page, i, set->split_first[i] + k);
    if ((double)page->cut > CUT_MANY * (double)set->images)
        report_note(set->report,
                    "%llu of %llu images have an object whose highlight or shadow is cut by the "
                    "image's edge; for fewer, lower chip.spread or make the images larger",
                    (unsigned long long)page->cut, (unsigned long long)set->images);
    THEN(status, write_contact_sheet(set, page->cell_height, &page->sheet));
    THEN(status, write_chips(page));
    THEN(status, path_in(set->report, path, set->folder, REPORT_PAGE));
    THEN(status, report_page_write(set->report, page_document(page), DIGITS, path));
    for (size_t i = 0; i < page->series_count; i++)
        free(page->series[i].values);
    json_decref(page->rows);
    json_decref(page->sheet);
    json_decref(page->classes);
    free(page->counts);
    free(page);
    return status;
}
