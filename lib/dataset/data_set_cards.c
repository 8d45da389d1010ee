/* The files that other programs read first: data.yaml of YOLO's trainers, and croissant.json, a
 * description in MLCommons' Croissant 1.0. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/sha256.h"
#include "dataset/data_set.h"

/* Returns the number of the first split that has one of two names; split_count: there is none. */
static size_t split_named(const struct data_set *set, const char *name, const char *other)
{
    size_t i = 0;
    while (i < set->split_count && strcmp(set->split_names[i], name) != 0 &&
           strcmp(set->split_names[i], other) != 0)
        i++;
    return i;
}

/* Returns the first or last split that is neither of two; split_count: there is none. */
static size_t split_but(const struct data_set *set, size_t one, size_t other, bool is_last)
{
    size_t found = set->split_count;
    for (size_t i = 0; i < set->split_count; i++)
        if (i != one && i != other && (is_last || found == set->split_count))
            found = i;
    return found;
}

/* Names the splits train and val for trainers. Where none is called so, train is the first split
 * without other use, and val the last one, or else train again, for tests stay unseen. Folders are
 * relative to data.yaml. */
sonject_status write_yolo_card(const struct data_set *set)
{
    struct growing_text text = {NULL, 0, 0, false};
    char path[PATH_CAPACITY];
    size_t i;
    const json_t *name;
    const size_t count = set->split_count;
    const size_t test = split_named(set, "test", "testing");
    size_t val = split_named(set, "val", "validation");
    size_t train = split_named(set, "train", "training");
    if (train == count)
        train = split_but(set, test, val, false);
    if (train == count) /* no other split is left */
        train = val < count ? val : test;
    if (val == count)
        val = split_but(set, test, train, true);
    if (val == count) {
        val = train;
        report_log(set->report,
                   "data.yaml uses %s/images also for validation, since no split is left for it; "
                   "for validation on images of its own, add val to the campaign's splits",
                   set->split_names[val]);
    }
    CHECK(path_in(set->report, path, set->folder, "data.yaml"));
    growing_text_add(&text, "# Targets injected by sonject, for trainers of YOLO: "
                            "yolo train data=data.yaml\n");
    growing_text_add(&text, "train: %s/images\nval: %s/images\n", set->split_names[train],
                     set->split_names[val]);
    if (test < count)
        growing_text_add(&text, "test: %s/images\n", set->split_names[test]);
    growing_text_add(&text, "names:\n");
    json_array_foreach(json_object_get(set->head, "classes"), i, name)
    {
        char *quoted = json_document_text(name, JSON_ENCODE_ANY); /* YAML's quotes are JSON's */
        text.failed = text.failed || !quoted;
        growing_text_add(&text, "  %zu: %s\n", i, quoted ? quoted : "");
        free(quoted);
    }
    return growing_text_write(set->report, &text, path);
}

/* ---- Croissant. */

/* The context of version 1.0, word for word as the standard has it. */
static const char context[] =
    "{\"@language\": \"en\", \"@vocab\": \"https://schema.org/\", \"citeAs\": \"cr:citeAs\", "
    "\"column\": \"cr:column\", \"conformsTo\": \"dct:conformsTo\", "
    "\"cr\": \"http://mlcommons.org/croissant/\", "
    "\"rai\": \"http://mlcommons.org/croissant/RAI/\", "
    "\"data\": {\"@id\": \"cr:data\", \"@type\": \"@json\"}, "
    "\"dataType\": {\"@id\": \"cr:dataType\", \"@type\": \"@vocab\"}, "
    "\"dct\": \"http://purl.org/dc/terms/\", \"equivalentProperty\": \"cr:equivalentProperty\", "
    "\"examples\": {\"@id\": \"cr:examples\", \"@type\": \"@json\"}, \"extract\": \"cr:extract\", "
    "\"field\": \"cr:field\", \"fileProperty\": \"cr:fileProperty\", "
    "\"fileObject\": \"cr:fileObject\", \"fileSet\": \"cr:fileSet\", \"format\": \"cr:format\", "
    "\"includes\": \"cr:includes\", \"isLiveDataset\": \"cr:isLiveDataset\", "
    "\"jsonPath\": \"cr:jsonPath\", \"key\": \"cr:key\", \"md5\": \"cr:md5\", "
    "\"parentField\": \"cr:parentField\", \"path\": \"cr:path\", \"recordSet\": \"cr:recordSet\", "
    "\"references\": \"cr:references\", \"regex\": \"cr:regex\", \"repeated\": \"cr:repeated\", "
    "\"replace\": \"cr:replace\", \"samplingRate\": \"cr:samplingRate\", "
    "\"sc\": \"https://schema.org/\", \"separator\": \"cr:separator\", \"source\": \"cr:source\", "
    "\"subField\": \"cr:subField\", \"transform\": \"cr:transform\"}";

/* Returns the media type for a file's name. */
static const char *format_of(const char *name)
{
    static const char *const types[][2] = {
        {".png", "image/png"},  {".tif", "image/tiff"},       {".json", "application/json"},
        {".jpg", "image/jpeg"}, {".xml", "application/xml"},  {".txt", "text/plain"},
        {".html", "text/html"}, {".yaml", "application/yaml"}};
    const char *extension = strrchr(name, '.');
    for (size_t i = 0; extension && i < COUNT(types); i++)
        if (strcmp(extension, types[i][0]) == 0)
            return types[i][1];
    return "application/octet-stream";
}

static sonject_status add_file(json_t **list, const struct data_set *set, const char *name)
{
    char path[PATH_CAPACITY], digest[SHA256_TEXT_CAPACITY], size[32];
    struct path_facts identity;
    CHECK(path_in(set->report, path, set->folder, "%s", name));
    CHECK(file_identify(set->report, path, &identity));
    snprintf(size, sizeof size, "%llu B", (unsigned long long)identity.bytes);
    CHECK(file_sha256(set->report, path, digest));
    json_append(list,
                JSON_OBJECT({"@type", json_string("cr:FileObject")}, {"@id", json_string(name)},
                            {"name", json_string(name)}, {"contentUrl", json_string(name)},
                            {"contentSize", json_string(size)},
                            {"encodingFormat", json_string(format_of(name))},
                            {"sha256", json_string(digest)}));
    return SONJECT_OK;
}

/* Adds the folders of a split. All images are taken to be of the type of the first one. */
static sonject_status add_folders(json_t **list, const struct data_set *set, size_t split)
{
    json_t *record = NULL;
    if (set->split_images[split] > 0)
        CHECK(data_set_record(set, split, set->split_first[split], &record));
    for (int i = 0; i < OUTPUT_KINDS; i++) {
        const struct output_kind *kind = &output_kinds[i];
        char name[64], files[80];
        if (!(set->outputs & OUTPUT_BIT(i)))
            continue;
        snprintf(name, sizeof name, "%s/%s", set->split_names[split], kind->folder);
        snprintf(files, sizeof files, "%s/*", name);
        const char *format =
            format_of(kind->extension ? kind->extension : member_text(record, "image"));
        json_append(list,
                    JSON_OBJECT({"@type", json_string("cr:FileSet")}, {"@id", json_string(name)},
                                {"name", json_string(name)}, {"includes", json_string(files)},
                                {"encodingFormat", json_string(format)}));
    }
    json_decref(record);
    return SONJECT_OK;
}

/* Returns a field "split/set/name" of records that come from a file or a folder. step, how: the key
 * and value that say how the field is extracted. */
static json_t *card_field(const char *record_set, const char *name, const char *type,
                          const char *source, const char *source_id, const char *step,
                          const char *how)
{
    char id[120];
    snprintf(id, sizeof id, "%s/%s", record_set, name);
    json_t *from = source ? JSON_OBJECT({source, JSON_OBJECT({"@id", json_string(source_id)})},
                                        {"extract", JSON_OBJECT({step, json_string(how)})})
                          : NULL;
    json_t *field = JSON_OBJECT({"@type", json_string("cr:Field")}, {"@id", json_string(id)},
                                {"name", json_string(id)}, {"dataType", json_string(type)});
    if (source)
        json_add(&field, "source", from);
    return field;
}

static json_t *record_set_of(const char *name, json_t *fields)
{
    return JSON_OBJECT({"@type", json_string("cr:RecordSet")}, {"@id", json_string(name)},
                       {"name", json_string(name)}, {"field", fields});
}

/* Adds the records of a split: images, and the objects in the COCO document. */
static void add_records(json_t **list, const char *split)
{
    static const char *const columns[][3] = {
        {"image_id", "sc:Integer", "$.annotations[*].image_id"},
        {"category_id", "sc:Integer", "$.annotations[*].category_id"},
        {"bbox", "cr:BoundingBox", "$.annotations[*].bbox"},
        {"area", "sc:Integer", "$.annotations[*].area"},
        {"truncated", "sc:Boolean", "$.annotations[*].truncated"}};
    char name[64], source[64];
    snprintf(source, sizeof source, "%s/images", split);
    snprintf(name, sizeof name, "%s/examples", split);
    json_t *fields = json_array();
    json_append(&fields, card_field(name, "file_name", "sc:Text", "fileSet", source, "fileProperty",
                                    "filename"));
    json_append(&fields, card_field(name, "image", "sc:ImageObject", "fileSet", source,
                                    "fileProperty", "content"));
    json_append(list, record_set_of(name, fields));
    snprintf(source, sizeof source, "%s/coco.json", split);
    snprintf(name, sizeof name, "%s/objects", split);
    fields = json_array();
    for (size_t i = 0; i < COUNT(columns); i++)
        json_append(&fields, card_field(name, columns[i][0], columns[i][1], "fileObject", source,
                                        "jsonPath", columns[i][2]));
    json_append(list, record_set_of(name, fields));
}

static void add_classes(json_t **list, const struct data_set *set)
{
    size_t i;
    const json_t *name;
    json_t *fields = json_array();
    json_t *data = json_array();
    json_append(&fields, card_field("classes", "id", "sc:Integer", NULL, NULL, NULL, NULL));
    json_append(&fields, card_field("classes", "name", "sc:Text", NULL, NULL, NULL, NULL));
    json_array_foreach(json_object_get(set->head, "classes"), i, name)
    {
        json_append(&data, JSON_OBJECT({"classes/id", json_count(i + 1)},
                                       {"classes/name", json_string(json_string_value(name))}));
    }
    json_t *classes = record_set_of("classes", fields);
    json_add(&classes, "data", data);
    json_append(list, classes);
}

sonject_status write_croissant(const struct data_set *set, const char *const *names, size_t count)
{
    char path[PATH_CAPACITY], name[SPLIT_NAME_CAPACITY + 16];
    json_t *files = json_array();
    json_t *records = json_array();
    sonject_status status = path_in(set->report, path, set->folder, "croissant.json");
    for (size_t i = 0; i < count; i++)
        THEN(status, add_file(&files, set, names[i]));
    add_classes(&records, set);
    for (size_t i = 0; i < set->split_count; i++) {
        snprintf(name, sizeof name, "%s/coco.json", set->split_names[i]);
        THEN(status, add_file(&files, set, name));
        THEN(status, add_folders(&files, set, i));
        add_records(&records, set->split_names[i]);
    }
    json_t *card = JSON_OBJECT(
        {"@context", json_loads(context, 0, NULL)}, {"@type", json_string("sc:Dataset")},
        {"conformsTo", json_string("http://mlcommons.org/croissant/1.0")},
        {"name", json_string("sonject")},
        {"description", json_string("Sonar images with injected targets, a campaign of sonject.")},
        {"identifier", json_string(member_text(set->head, "hash"))}, {"distribution", files},
        {"recordSet", records});
    return json_document_write(set->report, status, card, 9, path);
}
