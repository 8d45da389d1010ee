/* Labels of YOLO: a folder of texts, one for each image, and the classes' names in another file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "dataset/contact_reader.h"
#include "schema/yaml_tree.h"
#include "swath/swath_file.h"

struct yolo {
    struct contact_reader *reader;
    struct folder_names images[IMAGE_FOLDERS]; /* files in the reader's folders */
    json_t *names;    /* names of the classes by their numbers; NULL: none */
    char *names_file; /* file that has the names */
};

static sonject_status add_name(struct yolo *yolo, const char *number, const char *name)
{
    if (!text_is_printable(name))
        return input_failure(yolo->reader->report, yolo->names_file, "class %s is no text", number);
    return json_object_set_new(yolo->names, number, json_string(name)) == 0
               ? SONJECT_OK
               : report_out_of_memory(yolo->reader->report, "contacts");
}

/* Reads names, one in each line, the first of class 0. */
static sonject_status read_name_lines(struct yolo *yolo, char *text)
{
    char number[24];
    for (size_t i = 0; *text; i++) {
        const size_t length = strcspn(text, "\r\n");
        char *next = text + length + (text[length] == '\r');
        next += *next == '\n';
        text[length] = '\0';
        snprintf(number, sizeof number, "%zu", i);
        CHECK(add_name(yolo, number, text));
        text = next;
    }
    return SONJECT_OK;
}

/* Reads "names" in YAML: a list, or numbers with names. */
static sonject_status read_name_keys(struct yolo *yolo, const char *text, size_t bytes)
{
    struct tree tree;
    tree_init(&tree, yolo->reader->report, yolo->names_file);
    sonject_status status = tree_parse(&tree, text, bytes);
    const struct tree_entry *names = status == SONJECT_OK ? tree_find(&tree.root, "names") : NULL;
    for (size_t i = 0; status == SONJECT_OK && names && i < names->value.count; i++) {
        const struct tree_entry *entry = &names->value.entries[i];
        char number[24];
        snprintf(number, sizeof number, "%zu", i);
        if (entry->value.kind != TREE_TEXT || !entry->value.text)
            status = tree_failure(&tree, entry->place, "names", "a class's name must be a text");
        THEN(status, add_name(yolo, entry->key ? entry->key : number, entry->value.text));
    }
    tree_clear(&tree);
    return status;
}

/* Reads the classes' names from the first of their files that is there, beside or above the labels.
 */
static sonject_status read_names(struct yolo *yolo, const char *folder)
{
    static const char *const files[] = {"classes.txt", "../classes.txt", "data.yaml",
                                        "../data.yaml", "../../data.yaml"};
    struct report *report = yolo->reader->report;
    char *text;
    size_t bytes;
    for (size_t i = 0; i < COUNT(files); i++) {
        yolo->names_file = path_join(folder, files[i]);
        CHECK_MEMORY(report, yolo->names_file, "contacts");
        if (file_exists(yolo->names_file)) {
            yolo->names = json_object();
            CHECK_MEMORY(report, yolo->names, "contacts");
            CHECK(file_read_whole(report, yolo->names_file, TREE_BYTES_MAX, &text, &bytes));
            sonject_status status = SONJECT_OK;
            if (strlen(text) != bytes)
                status = input_failure(report, yolo->names_file, "is no text");
            THEN(status, name_ends(files[i], ".txt") ? read_name_lines(yolo, text)
                                                     : read_name_keys(yolo, text, bytes));
            free(text);
            return status;
        }
        free(yolo->names_file);
        yolo->names_file = NULL;
    }
    return SONJECT_OK;
}

static bool is_label(const char *name)
{
    static const char *const endings[] = {".txt", ".xml", ".json", ".csv", ".yaml", ".yml"};
    for (size_t i = 0; i < COUNT(endings); i++)
        if (name_ends(name, endings[i]))
            return true;
    return false;
}

static bool is_of_two_sides(struct report *report, const char *path)
{
    struct swath_file *file = NULL;
    const bool is =
        swath_file_open_array(report, path, SONJECT_CHANNEL_PORT, NULL, &file) == SONJECT_OK &&
        swath_file_recording(file);
    swath_file_close(&file);
    return is;
}

/* Opens the image whose name before the extension is that of its labels, for its size. place: of
 * the labels, for messages. */
static sonject_status find_image(struct yolo *yolo, const char *place, const char *label,
                                 struct labelled_image *image)
{
    struct contact_reader *reader = yolo->reader;
    const size_t length = strlen(label) - strlen("txt"); /* the name with its dot */
    sonject_status status = SONJECT_OK;
    for (size_t k = 0; k < IMAGE_FOLDERS; k++) {
        const struct folder_names *list = &yolo->images[k];
        size_t first = 0, end = list->count;
        while (first < end) {
            const size_t middle = first + (end - first) / 2;
            if (strncmp(list->names[middle], label, length) < 0)
                first = middle + 1;
            else
                end = middle;
        }
        for (; first < list->count && strncmp(list->names[first], label, length) == 0; first++) {
            const char *name = list->names[first];
            struct swath_file *file;
            struct raster_layout layout;
            if (strchr(name + length, '.') || is_label(name))
                continue;
            char *path = path_join(reader->folders[k], name);
            CHECK_MEMORY(reader->report, path, "contacts");
            status = swath_file_open_array(reader->report, path, SONJECT_CHANNEL_ONLY, NULL, &file);
            if (status == SONJECT_ERROR_INPUT && is_of_two_sides(reader->report, path))
                status = input_failure(reader->report, place,
                                       "the recording has two sides, and the label does not say "
                                       "which: list contacts in a .csv table with a column side, "
                                       "port or starboard");
            free(path);
            if (status == SONJECT_ERROR_INPUT || status == SONJECT_ERROR_UNSUPPORTED)
                continue; /* not an image; the message counts if no other file is one */
            CHECK(status);
            reader->report->message[0] = 0;
            swath_file_layout(file, &layout);
            swath_file_close(&file);
            image->rows = layout.rows;
            image->columns = layout.columns;
            return contact_reader_find_image(reader, place, name, &image->number);
        }
    }
    return status != SONJECT_OK
               ? status
               : input_failure(reader->report, place,
                               "there is no image of that name, neither beside the labels nor in "
                               "'images' below or beside them");
}

static sonject_status take_line(struct yolo *yolo, const char *place, const char *line,
                                const struct labelled_image *image)
{
    struct contact_reader *reader = yolo->reader;
    double numbers[5];
    size_t count = 0;
    char class_number[40], excerpt[60];
    const char *rest = line;
    while (count < COUNT(numbers) && text_to_number(rest, &numbers[count], &rest) &&
           (*rest == 0 || *rest == ' ' || *rest == '\t')) {
        rest += strspn(rest, " \t");
        count++;
    }
    if (count < COUNT(numbers) || *rest || !(numbers[0] >= 0.0 && numbers[0] <= 1e9) ||
        numbers[0] != floor(numbers[0]))
        return input_failure(reader->report, place,
                             "'%s' is not a class's number and four fractions: the box's centre x "
                             "and y, its width and height",
                             text_excerpt(excerpt, sizeof excerpt, line));
    snprintf(class_number, sizeof class_number, "%.0f", numbers[0]);
    const json_t *name = json_object_get(yolo->names, class_number);
    if (yolo->names && !name)
        return input_failure(reader->report, place, "class %s has no name in %s", class_number,
                             yolo->names_file);
    const char *class_name = name ? json_string_value(name) : class_number;
    bool is_chosen;
    CHECK(contact_reader_count(reader, class_name, &is_chosen));
    if (!is_chosen)
        return SONJECT_OK;
    const double rows = (double)image->rows, columns = (double)image->columns;
    return contact_reader_add(reader, place, image, part_of_class(class_name, reader->choice->part),
                              &(struct labelled_box){columns * (numbers[1] - 0.5 * numbers[3]),
                                                     rows * (numbers[2] - 0.5 * numbers[4]),
                                                     columns * numbers[3], rows * numbers[4]});
}

static sonject_status read_text(struct yolo *yolo, const char *path, const char *name)
{
    struct labelled_image image = {0, 0, 0, 0};
    char place[LABEL_PLACE], file[TABLE_FILE_CAPACITY];
    char *text;
    size_t bytes, number = 0;
    sonject_status status = SONJECT_OK;
    CHECK(file_read_whole(yolo->reader->report, path, LABEL_BYTES_MAX, &text, &bytes));
    text_excerpt(file, sizeof file, path);
    if (strlen(text) != bytes)
        status = input_failure(yolo->reader->report, path, "is no text");
    for (char *line = text, *next; status == SONJECT_OK && *line; line = next) {
        const size_t length = strcspn(line, "\n");
        next = line + length + (line[length] == '\n');
        line[length] = '\0';
        line[strcspn(line, "\r")] = '\0';
        line += strspn(line, " \t");
        snprintf(place, sizeof place, "%s:%zu", file, ++number);
        if (*line == 0)
            continue;
        if (image.rows == 0)
            status = find_image(yolo, place, name, &image);
        THEN(status, take_line(yolo, place, line, &image));
    }
    free(text);
    return status;
}

sonject_status contacts_of_yolo(struct contact_reader *reader, const char *folder,
                                const struct folder_names *names)
{
    struct yolo yolo = {.reader = reader};
    sonject_status status = read_names(&yolo, folder);
    for (size_t i = 0; status == SONJECT_OK && i < IMAGE_FOLDERS && reader->folders[i]; i++)
        status = folder_names_read(&yolo.images[i], reader->report, reader->folders[i], "");
    for (size_t i = 0; status == SONJECT_OK && i < names->count; i++) {
        const char *name = names->names[i];
        if (!name_ends(name, ".txt") || strcmp(name, "classes.txt") == 0)
            continue;
        char *path = path_join(folder, name);
        status =
            path ? read_text(&yolo, path, name) : report_out_of_memory(reader->report, "contacts");
        free(path);
    }
    for (size_t i = 0; i < IMAGE_FOLDERS; i++)
        folder_names_clear(&yolo.images[i]);
    json_decref(yolo.names);
    free(yolo.names_file);
    return status;
}
