#define _POSIX_C_SOURCE 200809L
#include "dataset/campaign_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/file_list.h"
#include "base/folder.h"
#include "base/json_document.h"
#include "base/memory.h"

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
    files->folder_length = strlen(folder) + strlen(split) + 2;
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

static const char *file_at(const struct image_files *files, size_t i)
{
    return i == 0 ? files->image : i == 1 ? files->truth : files->outputs[i - 2].path;
}

sonject_status image_files_list(const struct image_files *files, struct report *report,
                                json_t **list)
{
    sonject_status status = SONJECT_OK;
    *list = json_array();
    for (size_t i = 0; status == SONJECT_OK && i < files->output_count + 2; i++) {
        const char *path = file_at(files, i);
        json_t *entry;
        status = file_entry(report, path, path + files->folder_length, false, &entry);
        if (status == SONJECT_OK)
            json_append(list, entry);
    }
    if (status == SONJECT_OK && !*list)
        status = report_out_of_memory(report, "a list of files");
    if (status != SONJECT_OK) {
        json_decref(*list);
        *list = NULL;
    }
    return status;
}

sonject_status image_files_check(const struct image_files *files, struct report *report,
                                 const json_t *list, const char **changed)
{
    const size_t count = files->output_count + 2;
    *changed = json_array_size(list) == count ? NULL : files->record;
    for (size_t i = 0; !*changed && i < count; i++) {
        const char *path = file_at(files, i);
        const json_t *entry = json_array_get(list, i);
        const char *name = json_string_value(json_object_get(entry, "name"));
        bool holds = false;
        if (name && strcmp(name, path + files->folder_length) == 0)
            CHECK(file_entry_holds(report, entry, path, true, &holds));
        if (!holds)
            *changed = path;
    }
    return SONJECT_OK;
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

/* Files named as images are, and the folder where that is all. */
static sonject_status remove_images(struct report *report, const char *path)
{
    struct folder_names list;
    if (folder_names_read(&list, report, path, "") != SONJECT_OK)
        return SONJECT_OK;
    for (size_t i = 0; i < list.count; i++) {
        const bool is_image = strspn(list.names[i], "0123456789") == 8 && list.names[i][8] == '.';
        char *file = is_image ? path_join(path, list.names[i]) : NULL;
        if (file)
            file_discard(file);
        free(file);
    }
    folder_names_clear(&list);
    rmdir(path);
    return SONJECT_OK;
}

void split_folders_remove(const char *folder, const char *split)
{
    struct report ignored = {{0}, NULL, NULL};
    char *path = campaign_file(folder, split, NULL, NULL);
    char *coco = campaign_file(folder, split, "coco.json", NULL);
    each_folder(&ignored, folder, split, UINT32_MAX, remove_images);
    if (coco)
        file_discard(coco);
    if (path)
        rmdir(path);
    free(coco);
    free(path);
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
