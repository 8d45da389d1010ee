#include "api/stint_source.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define TEXTS_OF_FILE 3

static const char *text_of(const struct impulse_head *head, size_t number)
{
    const char *const of_file[TEXTS_OF_FILE] = {head->scene_path, head->scene_folder,
                                                head->scene_text};
    return number < TEXTS_OF_FILE ? of_file[number] : head->overrides[number - TEXTS_OF_FILE];
}

static sonject_status join_texts(struct stint_source *texts, struct report *report,
                                 const struct impulse_head *head)
{
    const size_t count = TEXTS_OF_FILE + head->override_count;
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += strlen(text_of(head, i)) + 1;
    char *joined = allocate_array(bytes, 1);
    if (!joined)
        return report_out_of_memory(report, "the scene's text");
    texts->texts = joined;
    for (size_t i = 0; i < count; i++) {
        const size_t length = strlen(text_of(head, i)) + 1;
        memcpy(joined + texts->bytes, text_of(head, i), length);
        texts->bytes += length;
    }
    return SONJECT_OK;
}

sonject_status stint_source_take(struct stint_source *texts, struct report *report,
                                 const struct scene_source *source)
{
    struct impulse_head head;
    memset(&head, 0, sizeof head);
    memset(texts, 0, sizeof *texts);
    if (!source || !source->text)
        return SONJECT_OK;
    sonject_status status = take_source(&head, report, source);
    if (status == SONJECT_OK)
        status = join_texts(texts, report, &head);
    impulse_head_clear(&head);
    return status;
}

static const char *next_text(const char **at, const char *end)
{
    const char *text = *at;
    if (text >= end)
        return NULL;
    *at = text + strlen(text) + 1;
    return text;
}

sonject_status stint_source_read(struct impulse_head *head, struct report *report,
                                 const struct stint_file *file)
{
    const char *at = file->source.texts;
    const char *end = at + file->source.bytes;
    memset(head, 0, sizeof *head);
    if (file->source.bytes == 0)
        return SONJECT_OK;
    const char *path = next_text(&at, end);
    const char *folder = next_text(&at, end);
    const char *text = next_text(&at, end);
    if (!text)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged: delete it", file->path);
    head->scene_path = copy_text(path);
    head->scene_folder = copy_text(folder);
    head->scene_text = copy_text(text);
    head->overrides = allocate_array((size_t)(end - at) + 1, sizeof *head->overrides);
    bool is_whole = head->scene_path && head->scene_folder && head->scene_text && head->overrides;
    while (is_whole && (text = next_text(&at, end)) != NULL) {
        head->overrides[head->override_count] = copy_text(text);
        is_whole = head->overrides[head->override_count] != NULL;
        head->override_count += is_whole;
    }
    return is_whole ? SONJECT_OK : report_out_of_memory(report, "the scene's text");
}
