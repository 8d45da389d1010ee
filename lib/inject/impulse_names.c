#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "inject/impulse_file.h"

const char *const *impulse_plane_names(enum impulse_kind kind)
{
    static const char *const names[IMPULSE_KINDS][IMPULSE_PLANES_MAX] = {
        [IMPULSES_SEABED] = {"energy", "in_view", NULL},
        [IMPULSES_OBJECT] = {"energy", "footprint", "lost"},
        [IMPULSES_GLINT] = {"real", "imaginary", NULL},
        [IMPULSES_BEAM] = {"energy", NULL, NULL},
        [IMPULSES_HIDDEN] = {"lost", NULL, NULL},
        [IMPULSES_LEVEL] = {"energy", NULL, NULL},
        [IMPULSES_CHAINS] = {"energy", NULL, NULL},
    };
    return names[kind];
}

void impulse_group_name(enum impulse_kind kind, uint32_t number, char name[IMPULSE_GROUP_CAPACITY])
{
    static const char *const folders[IMPULSE_KINDS] = {
        [IMPULSES_SEABED] = "/seabed", [IMPULSES_OBJECT] = "/objects", [IMPULSES_GLINT] = "/glints",
        [IMPULSES_BEAM] = "/beam",     [IMPULSES_HIDDEN] = "/hidden",  [IMPULSES_LEVEL] = "/level",
        [IMPULSES_CHAINS] = "/chains",
    };
    if (kind == IMPULSES_SEABED || kind == IMPULSES_BEAM || kind == IMPULSES_LEVEL)
        snprintf(name, IMPULSE_GROUP_CAPACITY, "%s", folders[kind]);
    else
        snprintf(name, IMPULSE_GROUP_CAPACITY, "%s/%" PRIu32, folders[kind], number);
}

void impulse_head_clear(struct impulse_head *head)
{
    for (size_t i = 0; i < head->override_count; i++)
        free(head->overrides[i]);
    free(head->overrides);
    free(head->scene_text);
    free(head->scene_path);
    free(head->scene_folder);
    free(head->image_path);
    memset(head, 0, sizeof *head);
}

void impulse_head_take_sonar(const struct impulse_head *head, sonject_sonar_params *sonar)
{
    sonar->bandwidth_hz = head->sonar.bandwidth_hz;
    sonar->along_track_resolution_m = head->sonar.along_track_resolution_m;
    sonar->response_window = head->sonar.response_window;
    sonar->taylor_sidelobe_db = head->sonar.taylor_sidelobe_db;
    sonar->taylor_terms = head->sonar.taylor_terms;
}
