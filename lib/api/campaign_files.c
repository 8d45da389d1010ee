#include "api/campaign_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"

#define DOCUMENT_BYTES_MAX ((size_t)64 << 20)

const struct output_file output_files[OUTPUT_KINDS] = {
    {OUTPUT_HIGHLIGHT, "highlight", ".png"},
    {OUTPUT_SHADOW, "shadow", ".png"},
    {OUTPUT_MASKS, "masks", ".png"},
    {OUTPUT_ENERGY, "energy", ".tif"},
    {OUTPUT_FIELD, "field", ".tif"},
    {OUTPUT_YOLO, "labels", ".txt"},
    {OUTPUT_VOC, "voc", ".xml"},
};

static const char *const common_folders[] = {"images", "truth", "records"};

const char *image_extension(enum pixel_type type, bool is_complex)
{
    return type == PIXEL_UINT8 && !is_complex ? ".png" : ".tif";
}

char *campaign_file(const char *folder, const char *split, const char *kind, const char *name)
{
    const char *parts[] = {folder, split, kind, name};
    size_t bytes = 1;
    for (size_t i = 0; i < 4 && parts[i]; i++)
        bytes += strlen(parts[i]) + 1;
    char *path = allocate_array(bytes, 1);
    for (size_t i = 0; path && i < 4 && parts[i]; i++) {
        if (i > 0)
            strcat(path, "/");
        strcat(path, parts[i]);
    }
    return path;
}

static char *numbered(const char *folder, const char *split, const char *kind, uint64_t id,
                      const char *extension)
{
    char name[48];
    snprintf(name, sizeof name, "%08llu%s", (unsigned long long)id, extension);
    return campaign_file(folder, split, kind, name);
}

sonject_status image_files_init(struct image_files *files, struct report *report,
                                const char *folder, const char *split, uint64_t id,
                                enum pixel_type type, bool is_complex, uint32_t outputs)
{
    memset(files, 0, sizeof *files);
    files->image = numbered(folder, split, "images", id, image_extension(type, is_complex));
    files->truth = numbered(folder, split, "truth", id, ".json");
    files->record = numbered(folder, split, "records", id, ".json");
    bool is_whole = files->image && files->truth && files->record;
    for (size_t i = 0; i < OUTPUT_KINDS; i++) {
        if (!(outputs & output_files[i].output))
            continue;
        char *path = numbered(folder, split, output_files[i].folder, id, output_files[i].extension);
        files->outputs[files->output_count].kind = &output_files[i];
        files->outputs[files->output_count++].path = path;
        is_whole = is_whole && path;
    }
    return is_whole ? SONJECT_OK : report_out_of_memory(report, "a file name");
}

void image_files_clear(struct image_files *files)
{
    free(files->image);
    free(files->truth);
    free(files->record);
    for (size_t i = 0; i < files->output_count; i++)
        free(files->outputs[i].path);
    memset(files, 0, sizeof *files);
}

bool image_files_exist(const struct image_files *files)
{
    if (!file_exists(files->record) || !file_exists(files->image) || !file_exists(files->truth))
        return false;
    for (size_t i = 0; i < files->output_count; i++)
        if (!file_exists(files->outputs[i].path))
            return false;
    return true;
}

/* Calls on each folder of a split. */
static sonject_status each_folder(struct report *report, const char *folder, const char *split,
                                  uint32_t outputs,
                                  sonject_status (*call)(struct report *report, const char *path))
{
    const size_t common = sizeof common_folders / sizeof *common_folders;
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < common + OUTPUT_KINDS; i++) {
        if (i >= common && !(outputs & output_files[i - common].output))
            continue;
        char *path = campaign_file(
            folder, split, i < common ? common_folders[i] : output_files[i - common].folder, NULL);
        status = path ? call(report, path) : report_out_of_memory(report, "a file name");
        free(path);
    }
    return status;
}

sonject_status split_folders_make(struct report *report, const char *folder, const char *split,
                                  uint32_t outputs)
{
    return each_folder(report, folder, split, outputs, folder_make);
}

static sonject_status tidy(struct report *report, const char *path)
{
    (void)report;
    folder_tidy(path);
    return SONJECT_OK;
}

void split_folders_tidy(const char *folder, const char *split, uint32_t outputs)
{
    struct report silent = {{0}, NULL, NULL};
    char *path = campaign_file(folder, split, NULL, NULL);
    each_folder(&silent, folder, split, outputs, tidy);
    if (path)
        folder_tidy(path);
    free(path);
}

sonject_status campaign_write_json(struct report *report, json_t *document, const char *path)
{
    char *text = json_document_text(document, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(document);
    if (!text)
        return report_out_of_memory(report, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}

/* Where memory is out jansson may find fault with the text: it is asked twice, and memory is. */
static json_t *load_json(const char *text, size_t bytes, bool *lacks_memory)
{
    json_t *document = json_loadb(text, bytes, 0, NULL);
    *lacks_memory = false;
    if (document)
        return document;
    document = json_loadb(text, bytes, 0, NULL);
    void *room = document ? NULL : allocate_array(bytes + 1, 2);
    *lacks_memory = !document && !room;
    free(room);
    return document;
}

sonject_status campaign_read_json(struct report *report, const char *path, json_t **document)
{
    char *text;
    size_t bytes;
    bool lacks_memory;
    *document = NULL;
    const sonject_status status = file_read_whole(report, path, DOCUMENT_BYTES_MAX, &text, &bytes);
    if (status != SONJECT_OK)
        return status;
    *document = load_json(text, bytes, &lacks_memory);
    free(text);
    if (lacks_memory)
        return report_out_of_memory(report, path);
    if (!json_is_object(*document)) {
        json_decref(*document);
        *document = NULL;
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: damaged: no JSON object; remove it and run the campaign again",
                              path);
    }
    return SONJECT_OK;
}
