#include "inject/kept_scene.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

#define TEXTS_OF_FILE 3

sonject_status kept_scene_join(struct sums_source *texts, struct report *report,
                               const struct scene_source *source)
{
    memset(texts, 0, sizeof *texts);
    if (!source || !source->text)
        return SONJECT_OK;
    char *folder = working_folder();
    const char *const of_file[TEXTS_OF_FILE] = {source->path, folder, source->text};
    const size_t count = TEXTS_OF_FILE + source->override_count;
    char *joined = NULL;
    for (int copies = 0; folder && copies < 2; copies++) {
        texts->bytes = 0;
        for (size_t i = 0; i < count; i++) {
            const char *text =
                i < TEXTS_OF_FILE ? of_file[i] : source->overrides[i - TEXTS_OF_FILE];
            if (joined)
                memcpy(joined + texts->bytes, text, strlen(text) + 1);
            texts->bytes += strlen(text) + 1;
        }
        if (!joined && !(joined = allocate_array(texts->bytes, 1)))
            break;
    }
    free(folder);
    texts->texts = joined;
    return joined ? SONJECT_OK : report_out_of_memory(report, "the scene's text");
}

static const char *next_text(const char **at, const char *end)
{
    const char *text = *at;
    if (text >= end)
        return NULL;
    *at = text + strlen(text) + 1;
    return text;
}

sonject_status kept_scene_find(struct kept_scene *kept, struct report *report,
                               const struct sums_file *file)
{
    const char *at = file->source.texts;
    const char *end = at + file->source.bytes;
    memset(kept, 0, sizeof *kept);
    if (file->source.bytes == 0)
        return SONJECT_OK;
    kept->path = next_text(&at, end);
    kept->folder = next_text(&at, end);
    kept->text = next_text(&at, end);
    if (!kept->text)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged: delete it", file->path);
    kept->overrides = allocate_array((size_t)(end - at) + 1, sizeof *kept->overrides);
    if (!kept->overrides)
        return report_out_of_memory(report, "the scene's text");
    for (const char *text; (text = next_text(&at, end)) != NULL;)
        kept->overrides[kept->override_count++] = text;
    return SONJECT_OK;
}
