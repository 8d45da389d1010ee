/* Labels as Pascal VOC has them: a folder of XML, one file an image, whole pixels counted from 1.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <expat.h>

#include "base/text.h"
#include "dataset/contact_reader.h"

#define WAY_CAPACITY   64
#define CLASS_CAPACITY 200

/* Names of the elements whose text is a number. */
static const char *const number_ways[] = {
    "/annotation/object/bndbox/xmin", "/annotation/object/bndbox/ymin",
    "/annotation/object/bndbox/xmax", "/annotation/object/bndbox/ymax",
    "/annotation/size/width",         "/annotation/size/height"};
enum {
    XMIN,
    YMIN,
    XMAX,
    YMAX,
    WIDTH,
    HEIGHT,
    NUMBERS
};

struct voc {
    struct contact_reader *reader;
    XML_Parser parser;
    sonject_status status; /* status of the reading so far */
    char file[TABLE_FILE_CAPACITY];
    /* Names down to the element that is read, "/annotation/object/name". Names of deeper elements
     * are left out once there is no room. */
    char way[WAY_CAPACITY];
    size_t depth, depth_in_way;
    char text[PATH_CAPACITY]; /* text of the element */
    size_t length;
    bool reads_objects; /* in a second reading: a file may name its image behind them */
    char image_name[PATH_CAPACITY];
    char class_name[CLASS_CAPACITY]; /* class of the object that is read; "": not read yet */
    double numbers[NUMBERS];         /* NaN: not read */
};

/* Keeps the first message and ends the parsing. */
static void refuse(struct voc *voc, const char *what, const char *detail)
{
    char excerpt[60];
    if (voc->status == SONJECT_OK)
        voc->status =
            report_failure(voc->reader->report, SONJECT_ERROR_INPUT, "%s:%lu: %s%s", voc->file,
                           (unsigned long)XML_GetCurrentLineNumber(voc->parser), what,
                           text_excerpt(excerpt, sizeof excerpt, detail));
    XML_StopParser(voc->parser, XML_FALSE);
}

static void begin_element(void *user, const XML_Char *name, const XML_Char **attributes)
{
    struct voc *voc = user;
    const size_t length = strlen(voc->way);
    (void)attributes;
    if (voc->depth == 0 && strcmp(name, "annotation") != 0)
        refuse(voc, "an annotation of VOC begins with <annotation>, not with ", name);
    if (voc->depth == voc->depth_in_way && length + strlen(name) + 2 <= sizeof voc->way) {
        snprintf(voc->way + length, sizeof voc->way - length, "/%s", name);
        voc->depth_in_way++;
    }
    voc->depth++;
    voc->length = 0;
    if (strcmp(voc->way, "/annotation/object") == 0 && voc->depth == voc->depth_in_way) {
        voc->class_name[0] = '\0';
        for (int i = XMIN; i <= YMAX; i++)
            voc->numbers[i] = NAN;
    }
}

static void add_text(void *user, const XML_Char *text, int length)
{
    struct voc *voc = user;
    if ((size_t)length >= sizeof voc->text - voc->length) {
        refuse(voc, "more text than an annotation has in ", voc->way);
        return;
    }
    memcpy(voc->text + voc->length, text, (size_t)length);
    voc->length += (size_t)length;
}

static void end_object(struct voc *voc)
{
    const double *numbers = voc->numbers;
    struct labelled_image image = {0, 0, 0, 0};
    char place[LABEL_PLACE];
    bool has_box = true;
    for (int i = XMIN; i <= YMAX; i++)
        has_box = has_box && !isnan(numbers[i]);
    if (!voc->class_name[0] || !has_box) {
        refuse(voc, "an object needs a name, and a bndbox of xmin, ymin, xmax, ymax", "");
        return;
    }
    bool is_chosen = false;
    voc->status = contact_reader_count(voc->reader, voc->class_name, &is_chosen);
    if (voc->status == SONJECT_OK && !is_chosen)
        return;
    image.rows = isnan(numbers[HEIGHT]) ? 0 : (uint64_t)numbers[HEIGHT];
    image.columns = isnan(numbers[WIDTH]) ? 0 : (uint64_t)numbers[WIDTH];
    snprintf(place, sizeof place, "%s:%lu", voc->file,
             (unsigned long)XML_GetCurrentLineNumber(voc->parser));
    THEN(voc->status,
         contact_reader_find_image(voc->reader, place, voc->image_name, &image.number));
    const struct labelled_box box = {numbers[XMIN] - 1.0, numbers[YMIN] - 1.0,
                                     numbers[XMAX] - numbers[XMIN] + 1.0,
                                     numbers[YMAX] - numbers[YMIN] + 1.0};
    THEN(voc->status,
         contact_reader_add(voc->reader, place, &image,
                            part_of_class(voc->class_name, voc->reader->choice->part), &box));
    if (voc->status != SONJECT_OK)
        XML_StopParser(voc->parser, XML_FALSE);
}

/* Takes the text of the element at the end of the way. */
static void take_text(struct voc *voc, const char *text)
{
    const char *rest;
    for (int i = 0; i < NUMBERS; i++) {
        if (strcmp(voc->way, number_ways[i]) != 0)
            continue;
        const double most = (double)IMAGE_PIXELS_MAX;
        if (!text_to_number(text, &voc->numbers[i], &rest) || *rest ||
            !(fabs(voc->numbers[i]) <= most) || (i >= WIDTH && !(voc->numbers[i] >= 0.0)))
            refuse(voc, "is no number of pixels: ", text);
    }
    if (strcmp(voc->way, "/annotation/object/name") == 0) {
        text_excerpt(voc->class_name, sizeof voc->class_name, text);
    } else if (strcmp(voc->way, "/annotation/filename") == 0) {
        memcpy(voc->image_name, text, strlen(text) + 1);
    }
}

static void end_element(void *user, const XML_Char *name)
{
    struct voc *voc = user;
    const bool is_in_way = voc->depth == voc->depth_in_way;
    (void)name;
    voc->text[voc->length] = '\0';
    while (voc->length > 0 && strchr(" \t\r\n", voc->text[voc->length - 1]))
        voc->text[--voc->length] = '\0';
    if (is_in_way && voc->reads_objects && strcmp(voc->way, "/annotation/object") == 0)
        end_object(voc);
    else if (is_in_way)
        take_text(voc, voc->text + strspn(voc->text, " \t\r\n"));
    voc->length = 0;
    voc->depth--;
    if (voc->depth_in_way > voc->depth) {
        *strrchr(voc->way, '/') = '\0';
        voc->depth_in_way--;
    }
}

static sonject_status parse(struct voc *voc, const char *text, size_t bytes)
{
    struct report *report = voc->reader->report;
    voc->parser = XML_ParserCreate(NULL);
    CHECK_MEMORY(report, voc->parser, voc->file);
    voc->way[0] = '\0';
    voc->depth = voc->depth_in_way = voc->length = 0;
    XML_SetUserData(voc->parser, voc);
    XML_SetElementHandler(voc->parser, begin_element, end_element);
    XML_SetCharacterDataHandler(voc->parser, add_text);
    const bool is_parsed = XML_Parse(voc->parser, text, (int)bytes, XML_TRUE) == XML_STATUS_OK;
    if (!is_parsed && XML_GetErrorCode(voc->parser) == XML_ERROR_NO_MEMORY)
        voc->status = report_out_of_memory(report, voc->file);
    else if (!is_parsed && voc->status == SONJECT_OK)
        refuse(voc, "no XML: ", XML_ErrorString(XML_GetErrorCode(voc->parser)));
    XML_ParserFree(voc->parser);
    return voc->status;
}

sonject_status contacts_of_voc(struct contact_reader *reader, const char *folder,
                               const struct folder_names *names)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < names->count; i++) {
        struct voc voc = {.reader = reader};
        char *text = NULL;
        size_t bytes;
        if (!name_ends(names->names[i], ".xml"))
            continue;
        for (int k = 0; k < NUMBERS; k++)
            voc.numbers[k] = NAN;
        char *path = path_join(folder, names->names[i]);
        CHECK_MEMORY(reader->report, path, "contacts");
        text_excerpt(voc.file, sizeof voc.file, path);
        status = file_read_whole(reader->report, path, LABEL_BYTES_MAX, &text, &bytes);
        free(path);
        THEN(status, parse(&voc, text, bytes));
        voc.reads_objects = true;
        THEN(status, parse(&voc, text, bytes));
        free(text);
    }
    return status;
}
