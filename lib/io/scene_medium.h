/* The water of a scene file on its way into the scene. */
#ifndef SONJECT_IO_SCENE_MEDIUM_H
#define SONJECT_IO_SCENE_MEDIUM_H

#include "io/scene_schema.h"
#include "medium/absorption.h"

/* What the section says, until it is the scene's. */
struct medium_text {
    sonject_medium_params medium;
    struct sea_water sea_water;
    struct water_layer *layers; /* owned, like all below */
    size_t layer_count;
    char *profile_file;
    double *heights_m, *depths_m, *speeds_mps;
    size_t height_count, depth_count, speed_count;
};

/* A profile, in scene_profile.c, which becomes the medium_text's layers. */
extern const struct section profile_section;

/* That the node is a list of 1...WATER_LAYERS_MAX entries. example: for the message. */
sonject_status check_list(struct reader *reader, const struct tree_node *node, const char *example);

/* What a check of layers or profiles says behind the name that its message begins with. */
const char *behind_name(const struct report *check);

#endif
