#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "inject/impulse_reading.h"
#include "inject/impulse_seal.h"

#define GROUP_NAME_MAX  64
#define TEXT_BYTES_MAX  ((size_t)1 << 16)
#define TEXTS_BYTES_MAX ((size_t)1 << 25)

sonject_status impulse_file_refuse(const struct impulse_file *file, const char *name,
                                   const char *what)
{
    if (file->failure != SONJECT_OK)
        return file->failure;
    return report_failure(file->report, SONJECT_ERROR_INPUT, "%s: %s %s: trace again",
                          file->file.path, name, what);
}

bool impulse_file_ask(struct impulse_file *file, enum decoder_function function, const char *group,
                      const char *name, const struct region *region, struct decoder_reply *reply,
                      struct decoder_bytes *out)
{
    char texts[2 * GROUP_NAME_MAX];
    struct decoder_request request = {.function = (uint32_t)function};
    memset(reply, 0, sizeof *reply);
    if (file->failure != SONJECT_OK || strlen(group) >= GROUP_NAME_MAX ||
        strlen(name) >= GROUP_NAME_MAX)
        return false;
    strcpy(texts, group);
    strcpy(texts + strlen(group) + 1, name);
    request.bytes = strlen(group) + strlen(name) + 2;
    if (region)
        request.region = *region;
    const sonject_status status =
        decoder_ask(file->report, &file->file, &request, texts, reply, out);
    if (status != SONJECT_ERROR_INPUT)
        file->failure = status;
    return status == SONJECT_OK;
}

bool impulse_file_integer(struct impulse_file *file, const char *group, const char *name,
                          int64_t low, int64_t high, int32_t *value)
{
    struct decoder_reply reply;
    if (!impulse_file_ask(file, DECODER_INTEGER, group, name, NULL, &reply, NULL))
        return false;
    const int64_t integer = (int64_t)reply.value;
    *value = (int32_t)integer;
    return integer >= low && integer <= high && integer == *value;
}

static bool read_whole(struct impulse_file *file, const char *group, const char *name,
                       uint64_t *value)
{
    struct decoder_reply reply;
    const bool is_read = impulse_file_ask(file, DECODER_WHOLE, group, name, NULL, &reply, NULL);
    *value = reply.value;
    return is_read;
}

static bool read_number(struct impulse_file *file, const char *group, const char *name,
                        double *value)
{
    struct decoder_reply reply;
    const bool is_read = impulse_file_ask(file, DECODER_NUMBER, group, name, NULL, &reply, NULL);
    memcpy(value, &reply.value, sizeof *value);
    return is_read;
}

/* *text is to be given to free(). */
static bool read_text(struct impulse_file *file, const char *group, const char *name, char **text)
{
    struct decoder_reply reply;
    struct decoder_bytes out = {NULL, TEXT_BYTES_MAX, 0};
    const bool is_read = impulse_file_ask(file, DECODER_TEXT, group, name, NULL, &reply, &out);
    *text = out.bytes;
    return is_read;
}

static bool read_short_text(struct impulse_file *file, const char *group, const char *name,
                            char *text, size_t capacity)
{
    struct decoder_reply reply;
    struct decoder_bytes out = {text, capacity, 0};
    return impulse_file_ask(file, DECODER_TEXT, group, name, NULL, &reply, &out) && out.count > 0 &&
           text[out.count - 1] == '\0';
}

/* Each is to be given to free(), and *texts; none where there is no such dataset. */
static bool read_texts(struct impulse_file *file, const char *group, const char *name,
                       char ***texts, size_t *count)
{
    struct decoder_reply reply;
    struct decoder_bytes out = {NULL, TEXTS_BYTES_MAX, 0};
    *count = 0;
    if (!impulse_file_ask(file, DECODER_TEXTS, group, name, NULL, &reply, &out))
        return false;
    const char *text = out.bytes;
    const char *end = text + out.count;
    *texts = reply.value <= out.count ? allocate_array((size_t)reply.value, sizeof **texts) : NULL;
    bool is_whole = *texts != NULL;
    while (is_whole && *count < reply.value && text < end) {
        (*texts)[*count] = copy_text(text);
        is_whole = (*texts)[*count] != NULL;
        *count += is_whole;
        text += strlen(text) + 1;
    }
    is_whole = is_whole && *count == reply.value;
    free(out.bytes);
    return is_whole;
}

struct head_group {
    const char *name;
    bool (*read)(struct impulse_file *file, const char *group);
};

static bool read_scene(struct impulse_file *file, const char *group)
{
    struct impulse_head *head = &file->head;
    char **texts = NULL;
    size_t count = 0;
    if (!read_short_text(file, group, "hash", head->scene_hash, sizeof head->scene_hash) ||
        !read_whole(file, group, "seed", &head->seed))
        return false;
    const bool is_read = read_texts(file, group, "text", &texts, &count);
    for (size_t i = 1; i < count; i++)
        free(texts[i]);
    head->scene_text = count > 0 ? texts[0] : NULL;
    free(texts);
    if (!is_read || !head->scene_text)
        return is_read;
    return read_text(file, group, "path", &head->scene_path) &&
           read_text(file, group, "folder", &head->scene_folder) &&
           read_texts(file, group, "overrides", &head->overrides, &head->override_count);
}

static bool read_image(struct impulse_file *file, const char *group)
{
    struct impulse_head *head = &file->head;
    return read_text(file, group, "path", &head->image_path) &&
           read_whole(file, group, "rows", &head->image_rows) &&
           read_whole(file, group, "columns", &head->image_columns) &&
           read_short_text(file, group, "xxhash", head->image_hash, sizeof head->image_hash);
}

static bool read_sonar(struct impulse_file *file, const char *group)
{
    sonject_sonar_params *sonar = &file->head.sonar;
    int32_t window = 0;
    int32_t terms = 0;
    const bool is_done =
        read_number(file, group, "bandwidth_hz", &sonar->bandwidth_hz) &&
        read_number(file, group, "along_track_resolution_m", &sonar->along_track_resolution_m) &&
        read_number(file, group, "taylor_sidelobe_db", &sonar->taylor_sidelobe_db) &&
        impulse_file_integer(file, group, "response_window", 0, INT32_MAX, &window) &&
        impulse_file_integer(file, group, "taylor_terms", 0, INT32_MAX, &terms);
    sonar->response_window = (uint32_t)window;
    sonar->taylor_terms = (uint32_t)terms;
    return is_done;
}

static bool read_patch(struct impulse_file *file, const char *group)
{
    struct impulse_head *head = &file->head;
    return read_whole(file, group, "first_row", &head->first_row) &&
           read_whole(file, group, "first_column", &head->first_column) &&
           read_whole(file, group, "rows", &head->rows) &&
           read_whole(file, group, "columns", &head->columns) &&
           read_number(file, group, "row_spacing_m", &head->row_spacing_m) &&
           read_number(file, group, "column_spacing_m", &head->column_spacing_m) &&
           read_number(file, group, "first_slant_range_m", &head->first_slant_range_m);
}

static bool read_counts(struct impulse_file *file, const char *group)
{
    struct impulse_head *head = &file->head;
    return read_whole(file, group, "pings", &head->counts.pings) &&
           read_whole(file, group, "rays", &head->counts.rays) &&
           read_whole(file, group, "ray_queries", &head->counts.queries) &&
           read_whole(file, group, "impulses", &head->counts.impulses);
}

static sonject_status read_head(struct impulse_file *file)
{
    static const struct head_group groups[] = {{"/scene", read_scene},
                                               {"/image", read_image},
                                               {"/sonar", read_sonar},
                                               {"/patch", read_patch},
                                               {"/counts", read_counts}};
    char format[sizeof IMPULSE_FORMAT];
    int32_t version = 0;
    if (!read_short_text(file, "/", "format", format, sizeof format) ||
        strcmp(format, IMPULSE_FORMAT) != 0 ||
        !impulse_file_integer(file, "/", "format_version", 0, INT32_MAX, &version))
        return impulse_file_refuse(file, "its format", "is not that of a file of impulses");
    if (version != IMPULSE_FORMAT_VERSION)
        return report_failure(file->report, SONJECT_ERROR_INPUT,
                              "%s: its format is %ld, but this build reads %d: trace again",
                              file->file.path, (long)version, IMPULSE_FORMAT_VERSION);
    if (!read_short_text(file, "/", "sonject", file->head.version, sizeof file->head.version))
        return impulse_file_refuse(file, "its version", "is damaged");
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
        if (!groups[i].read(file, groups[i].name))
            return impulse_file_refuse(file, groups[i].name, "is damaged");
    return SONJECT_OK;
}

sonject_status impulse_file_open(struct report *report, const char *path,
                                 struct impulse_file **file)
{
    struct file_identity identity;
    struct decoder_reply reply;
    *file = NULL;
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such file of impulses; check its name", path);
    sonject_status status = file_identify(report, path, &identity);
    if (status == SONJECT_OK)
        status = impulse_seal_check(report, path);
    if (status != SONJECT_OK)
        return status;
    struct impulse_file *made = allocate_array(1, sizeof *made);
    if (!made)
        return report_out_of_memory(report, "a file of impulses");
    made->report = report;
    status = decoder_open(report, DECODER_OPEN_TREE, path, NULL, NULL, &made->file, &reply);
    if (status == SONJECT_OK)
        status = read_head(made);
    if (status == SONJECT_OK)
        *file = made;
    else
        impulse_file_close(&made);
    return status;
}

const struct impulse_head *impulse_file_head(const struct impulse_file *file)
{
    return &file->head;
}

void impulse_file_close(struct impulse_file **file)
{
    if (!*file)
        return;
    decoder_close(&(*file)->file);
    impulse_head_clear(&(*file)->head);
    free(*file);
    *file = NULL;
}
