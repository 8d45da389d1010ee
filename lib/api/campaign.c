#include "api/campaign_handle.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/scene_file.h"
#include "io/yaml_flow.h"

/* What the scene reader says of "--set KEY: what" is the campaign file's where that drew the key.
 */
static bool place_line(struct tree *tree, const struct image_plan *plan, const char *line)
{
    static const char start[] = "--set ";
    if (strncmp(line, start, strlen(start)) != 0)
        return false;
    line += strlen(start);
    for (size_t i = 0; i < plan->key_count; i++) {
        const char *text = plan->keys[i].text;
        const size_t length = strcspn(text, "=");
        if (plan->keys[i].place.line == 0 || strncmp(line, text, length) != 0 ||
            !strchr(":.[", line[length]))
            continue;
        char key[256];
        const size_t end = strcspn(line, ":");
        snprintf(key, sizeof key, "%.*s", (int)end, line);
        tree_failure(tree, plan->keys[i].place, key, "%s", line + end + (line[end] == ':') + 1);
        return true;
    }
    return false;
}

static void place_message(struct sonject_campaign *campaign, const struct image_plan *plan)
{
    static const struct tree_place behind = {NULL, SIZE_MAX, 1};
    char message[REPORT_CAPACITY];
    struct mistakes mistakes = {NULL, 0, 0, 0};
    struct tree *tree = &campaign->campaign.tree;
    memcpy(message, campaign->report->message, sizeof message);
    tree->mistakes = &mistakes;
    for (char *line = message, *next; *line; line = next) {
        next = line + strcspn(line, "\n");
        next += *next ? (*next = 0, 1) : 0;
        if (!place_line(tree, plan, line))
            mistakes_add(&mistakes, tree, &behind, line, line);
    }
    tree->mistakes = NULL;
    mistakes_tell(&mistakes, campaign->report, SONJECT_ERROR_INPUT);
}

sonject_status campaign_read_scene(struct sonject_campaign *campaign, const struct image_plan *plan,
                                   struct scene *scene)
{
    const struct swath_plan *swath = &campaign->campaign.swaths[plan->swath];
    const struct tree_node path = {.kind = TREE_TEXT, .is_quoted = true, .text = swath->path};
    struct growing_text input = {NULL, 0, 0, false};
    const char **overrides = allocate_array(plan->key_count + 1, sizeof *overrides);
    growing_text_add(&input, "input.path=");
    tree_write_flow(&path, &input);
    char *input_text = growing_text_end(&input);
    sonject_status status = overrides && input_text
                                ? SONJECT_OK
                                : report_out_of_memory(campaign->report, "an image's scene");
    if (status == SONJECT_OK) {
        for (size_t i = 0; i < plan->key_count; i++)
            overrides[i] = plan->keys[i].text;
        overrides[plan->key_count] = input_text;
        const struct scene_text source = {campaign->campaign.scene_path,
                                          campaign->scene_text,
                                          campaign->scene_bytes,
                                          overrides,
                                          plan->key_count + 1,
                                          campaign->campaign.folder,
                                          plan->key_count,
                                          campaign->allows_user_shapes};
        status = scene_text_read(campaign->report, &source, scene);
        if (status != SONJECT_OK)
            place_message(campaign, plan);
    }
    free(overrides);
    free(input_text);
    return status;
}

static sonject_status take_classes(struct sonject_campaign *campaign)
{
    const struct campaign *plan = &campaign->campaign;
    uint32_t number;
    for (size_t i = 0; i < plan->target_count + plan->clutter_count; i++) {
        const struct item *item =
            i < plan->target_count ? &plan->targets[i] : &plan->clutter[i - plan->target_count];
        CHECK(class_names_take(&campaign->classes, campaign->report, item->class_name, &number));
    }
    return SONJECT_OK;
}

static sonject_status open_campaign(struct sonject_campaign *campaign, const char *path,
                                    const char *const *overrides, size_t count)
{
    struct campaign *plan = &campaign->campaign;
    CHECK(campaign_read(campaign->report, path, overrides, count, plan));
    CHECK(scene_file_load(campaign->report, plan->scene_path, &campaign->scene_text,
                          &campaign->scene_bytes));
    CHECK(take_classes(campaign));
    campaign->swath_hashes = allocate_array(plan->swath_count, sizeof *campaign->swath_hashes);
    CHECK_MEMORY(campaign->report, campaign->swath_hashes, "the campaign");
    return campaign_check(campaign);
}

void sonject_campaign_read_params_init(sonject_campaign_read_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

sonject_status sonject_campaign_read(sonject_context *context, const char *path,
                                     const char *const *overrides, size_t count,
                                     const sonject_campaign_read_params *params,
                                     sonject_campaign **campaign)
{
    if (!context || !campaign)
        return SONJECT_ERROR_ARGUMENT;
    *campaign = NULL;
    context_begin_call(context);
    sonject_campaign_read_params taken;
    sonject_campaign_read_params_init(&taken);
    sonject_status status = SONJECT_OK;
    if (params)
        status = params_take(&context->report, &taken, sizeof taken, params, sizeof taken,
                             "campaign read parameters");
    if (status != SONJECT_OK)
        return status;
    if (!path || (count > 0 && !overrides))
        return null_argument(&context->report, "path and overrides");
    for (size_t i = 0; i < count; i++)
        if (!overrides[i])
            return null_argument(&context->report, "an override");
    struct sonject_campaign *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(&context->report, made, "a campaign");
    made->report = &context->report;
    made->allows_user_shapes = taken.allows_user_shapes != 0;
    status = open_campaign(made, path, overrides, count);
    if (status != SONJECT_OK)
        sonject_campaign_release(&made);
    *campaign = made;
    return status;
}

void sonject_campaign_release(sonject_campaign **campaign)
{
    if (!campaign || !*campaign)
        return;
    campaign_clear(&(*campaign)->campaign);
    swath_store_close(&(*campaign)->store);
    mesh_store_clear(&(*campaign)->meshes);
    class_names_clear(&(*campaign)->classes);
    json_decref((*campaign)->inputs);
    free((*campaign)->scene_text);
    free((*campaign)->swath_hashes);
    free(*campaign);
    *campaign = NULL;
}
