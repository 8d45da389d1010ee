/* Sets of labelled contacts: their formats, images and boxes. */
#include "dataset/contact_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/contact_reader.h"

#define CONTACTS_MAX 100000

/* ---- What readers add. */

static char small(char letter)
{
    return letter >= 'A' && letter <= 'Z' ? (char)(letter - 'A' + 'a') : letter;
}

static bool begins(const char *text, const char *word)
{
    while (*word && small(*text) == *word)
        text++, word++;
    return *word == 0;
}

bool name_ends(const char *name, const char *ending)
{
    const size_t length = strlen(name);
    return length >= strlen(ending) && begins(name + length - strlen(ending), ending);
}

uint32_t part_of_class(const char *name, uint32_t part)
{
    const bool has_shadow = contains_ignoring_case(name, "shadow");
    const bool has_highlight =
        contains_ignoring_case(name, "highlight") || contains_ignoring_case(name, "echo");
    return has_shadow && has_highlight ? LABELLED_BOTH
           : has_shadow                ? LABELLED_SHADOW
           : has_highlight             ? LABELLED_HIGHLIGHT
                                       : part;
}

sonject_status contact_reader_count(struct contact_reader *reader, const char *class_name,
                                    bool *is_chosen)
{
    const struct contact_choice *choice = reader->choice;
    const json_int_t before = json_integer_value(json_object_get(reader->classes, class_name));
    *is_chosen = choice->class_count == 0;
    for (size_t i = 0; i < choice->class_count; i++)
        *is_chosen = *is_chosen || strcmp(class_name, choice->classes[i]) == 0;
    if (json_object_set_new_nocheck(reader->classes, class_name, json_integer(before + 1)) != 0)
        return report_out_of_memory(reader->report, "contacts");
    return SONJECT_OK;
}

/* Lists the classes whose names tell no part, "boulder (40), mine (60)". Returns their number. */
static size_t list_classes(const struct contact_reader *reader, char *text, size_t capacity)
{
    const char *name;
    json_t *labels;
    size_t count = 0, length = 0;
    json_object_foreach(reader->classes, name, labels)
    {
        char excerpt[40];
        if (part_of_class(name, UINT32_MAX) != UINT32_MAX || length + 80 > capacity)
            continue;
        length +=
            (size_t)snprintf(text + length, capacity - length, "%s%s (%lld)", count > 0 ? ", " : "",
                             text_excerpt(excerpt, sizeof excerpt, *name ? name : "no class"),
                             (long long)json_integer_value(labels));
        count++;
    }
    return count;
}

/* Returns the path of an image's file, for free(); NULL: there is none, or memory is out. */
static char *find_file(const struct contact_reader *reader, const char *name, bool *has_memory)
{
    *has_memory = true;
    for (size_t i = 0; i < IMAGE_FOLDERS && reader->folders[i]; i++) {
        char *path = path_join(reader->folders[i], name);
        *has_memory = path != NULL;
        if (!path || file_exists(path))
            return path;
        free(path);
    }
    return NULL;
}

/* Returns a key of the file itself, since an image may have several names. No printable name is
 * such a key. Returns the name where the system does not tell one file from another. */
static const char *file_key(const char *path, const char *name, char *text, size_t capacity)
{
    struct path_facts facts;
    if (path_facts_read(path, &facts) != 0 || facts.number == 0)
        return name;
    snprintf(text, capacity, "\n%llu %llu", (unsigned long long)facts.device,
             (unsigned long long)facts.number);
    return text;
}

sonject_status contact_reader_find_image(struct contact_reader *reader, const char *place,
                                         const char *name, uint32_t *number)
{
    struct contact_set *set = reader->set;
    char excerpt[200];
    bool has_memory;
    const json_t *known = json_object_get(reader->images, name);
    *number = (uint32_t)json_integer_value(known);
    if (known)
        return SONJECT_OK;
    if (*name == 0 || !text_is_printable(name))
        return input_failure(reader->report, place,
                             *name ? "the image's name must be a text" : "no image is named");
    char *path = find_file(reader, name, &has_memory);
    if (!path && has_memory)
        return input_failure(reader->report, place,
                             "there is no image '%s', neither beside the labels nor in 'images' "
                             "below or beside them",
                             text_excerpt(excerpt, sizeof excerpt, name));
    char text[64];
    const char *key = path ? file_key(path, name, text, sizeof text) : name;
    known = json_object_get(reader->images, key);
    *number = known ? (uint32_t)json_integer_value(known) : (uint32_t)set->image_count;
    char **images = grow_doubling(set->images, set->image_count, sizeof *images);
    set->images = images ? images : set->images;
    if (!path || !images ||
        json_object_set_new_nocheck(reader->images, name, json_integer(*number)) != 0 ||
        json_object_set_new_nocheck(reader->images, key, json_integer(*number)) != 0) {
        free(path);
        return report_out_of_memory(reader->report, "contacts");
    }
    if (*number < set->image_count) {
        free(path);
        return SONJECT_OK;
    }
    set->images[set->image_count++] = path;
    return SONJECT_OK;
}

/* Rounds an interval to whole pixels, one at least, of count; count 0: not known. */
static void take_pixels(double start, double length, uint64_t count, uint64_t *first,
                        uint64_t *pixels)
{
    const double last = count > 0 ? (double)count : (double)IMAGE_PIXELS_MAX;
    const double begin = fmin(fmax(floor(start + 0.5), 0.0), last - 1.0);
    const double end = fmax(fmin(floor(start + length + 0.5), last), begin + 1.0);
    *first = (uint64_t)begin;
    *pixels = (uint64_t)(end - begin);
}

/* Returns whether an interval is within count pixels, give or take one; count 0: not known. */
static bool is_inside(double start, double length, uint64_t count)
{
    const double last = count > 0 ? (double)count : (double)IMAGE_PIXELS_MAX;
    return start >= -1.0 && start + length <= last + 1.0;
}

sonject_status contact_reader_add(struct contact_reader *reader, const char *place,
                                  const struct labelled_image *image, uint32_t part,
                                  const struct labelled_box *box)
{
    struct contact_set *set = reader->set;
    if (!(box->rows > 0.0 && box->columns > 0.0))
        return input_failure(reader->report, place,
                             "the box has no area: %g rows and %g columns; mend or remove it",
                             box->rows, box->columns);
    if (!is_inside(box->row, box->rows, image->rows) ||
        !is_inside(box->column, box->columns, image->columns)) {
        char size[80] = "";
        if (image->rows > 0 && image->columns > 0)
            snprintf(size, sizeof size, " of %llu rows and %llu columns",
                     (unsigned long long)image->rows, (unsigned long long)image->columns);
        return input_failure(reader->report, place,
                             "the box, rows %g to %g and columns %g to %g, is not in the image%s",
                             box->row, box->row + box->rows, box->column,
                             box->column + box->columns, size);
    }
    if (set->count == CONTACTS_MAX)
        return input_failure(reader->report, place, "more than %d contacts; leave some out",
                             CONTACTS_MAX);
    CHECK(grow_list(reader->report, &set->contacts, set->count, sizeof *set->contacts, "contacts"));
    struct labelled_contact *contact = &set->contacts[set->count++];
    *contact = (struct labelled_contact){.image = image->number,
                                         .part = part,
                                         .side = image->side,
                                         .image_rows = image->rows,
                                         .image_columns = image->columns};
    take_pixels(box->row, box->rows, image->rows, &contact->box.first_row, &contact->box.rows);
    take_pixels(box->column, box->columns, image->columns, &contact->box.first_column,
                &contact->box.columns);
    return SONJECT_OK;
}

/* ---- Reading. */

/* Returns "data/images/train" for "data/labels/train"; NULL: there is none, or memory is out. */
static char *folder_of_images(const char *folder)
{
    for (size_t at = strlen(folder); at-- > 0;)
        if ((at == 0 || is_divider(folder[at - 1])) && begins(folder + at, "labels") &&
            (folder[at + 6] == 0 || is_divider(folder[at + 6]))) {
            char *images = copy_text(folder);
            if (images)
                memcpy(images + at, "images", 6);
            return images;
        }
    return NULL;
}

static sonject_status find_folders(struct contact_reader *reader, const char *folder)
{
    static const char *const beside[] = {"images", "..", "../images", "../JPEGImages"};
    reader->folders[0] = copy_text(folder);
    for (size_t i = 0; i < COUNT(beside); i++)
        reader->folders[i + 1] = path_join(folder, beside[i]);
    for (size_t i = 0; i <= COUNT(beside); i++)
        CHECK_MEMORY(reader->report, reader->folders[i], "contacts");
    reader->folders[COUNT(beside) + 1] = folder_of_images(folder);
    return SONJECT_OK;
}

/* Reads a folder of labels: YOLO's, or VOC's where both are there, since VOC's tell more. */
static sonject_status read_folder(struct contact_reader *reader, const char *path)
{
    struct folder_names names;
    bool has_xml = false, has_text = false;
    CHECK(folder_names_read(&names, reader->report, path, ""));
    for (size_t i = 0; i < names.count; i++) {
        has_xml = has_xml || name_ends(names.names[i], ".xml");
        has_text = has_text || name_ends(names.names[i], ".txt");
    }
    sonject_status status = find_folders(reader, path);
    if (status == SONJECT_OK && !has_xml && !has_text)
        status = input_failure(reader->report, path,
                               "no labels: neither .json (COCO), .csv, .yaml (quantiles) nor a "
                               "folder of .txt (YOLO) or .xml (VOC)");
    THEN(status,
         has_xml ? contacts_of_voc(reader, path, &names) : contacts_of_yolo(reader, path, &names));
    folder_names_clear(&names);
    return status;
}

static sonject_status read_labels(struct contact_reader *reader, const char *path)
{
    if (!file_exists(path))
        return input_failure(reader->report, path, "there is no such file or folder of labels");
    if (name_ends(path, ".yaml") || name_ends(path, ".yml"))
        return quantiles_of_file(reader, path);
    const bool is_coco = name_ends(path, ".json");
    reader->images = json_object();
    reader->classes = json_object();
    CHECK_MEMORY(reader->report, reader->images && reader->classes, "contacts");
    if (is_coco || name_ends(path, ".csv")) {
        char *folder = path_folder(path);
        CHECK_MEMORY(reader->report, folder, "contacts");
        sonject_status status = find_folders(reader, folder);
        free(folder);
        THEN(status, (is_coco ? contacts_of_coco : contacts_of_table)(reader, path));
        CHECK(status);
    } else {
        CHECK(read_folder(reader, path));
    }
    char classes[400] = "";
    const size_t class_count = list_classes(reader, classes, sizeof classes);
    if (reader->set->count == 0 && class_count > 0)
        return input_failure(reader->report, path,
                             "holds no contacts of the chosen classes, but of %s", classes);
    if (reader->set->count == 0)
        return input_failure(reader->report, path, "holds no contacts");
    if (reader->choice->class_count == 0 && class_count > 1)
        report_note(reader->report, "contacts of %zu classes are treated as one class: %s",
                    class_count, classes);
    return SONJECT_OK;
}

sonject_status contact_set_read(struct report *report, const char *path,
                                const struct contact_choice *choice, struct contact_set *set)
{
    struct contact_reader reader = {.report = report, .set = set, .choice = choice};
    memset(set, 0, sizeof *set);
    const sonject_status status = read_labels(&reader, path);
    for (size_t i = 0; i < IMAGE_FOLDERS; i++)
        free(reader.folders[i]);
    json_decref(reader.images);
    json_decref(reader.classes);
    return status;
}

void contact_set_clear(struct contact_set *set)
{
    for (size_t i = 0; i < set->image_count; i++)
        free(set->images[i]);
    free(set->images);
    free(set->contacts);
    memset(set, 0, sizeof *set);
}
