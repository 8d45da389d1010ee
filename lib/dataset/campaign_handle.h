/* A campaign as the library keeps it, and one image of it. */
#ifndef SONJECT_DATASET_CAMPAIGN_HANDLE_H
#define SONJECT_DATASET_CAMPAIGN_HANDLE_H

#include <jansson.h>

#include <sonject/campaign.h>

#include "base/hash.h"
#include "dataset/campaign.h"
#include "dataset/image_plan.h"
#include "dataset/labels.h"
#include "inject/injection.h"
#include "inject/swath.h"

struct sonject_campaign {
    struct report *report; /* the context's */
    struct campaign campaign;
    char *scene_text; /* of the base scene's file; owned */
    size_t scene_bytes;
    bool allows_user_shapes;
    bool has_user_shapes;                     /* among what may be drawn */
    char (*swath_hashes)[HASH_TEXT_CAPACITY]; /* of the swaths' files; owned */
    json_t *inputs;                           /* all that images depend on, by name; owned */
    char hash[HASH_TEXT_CAPACITY];            /* of inputs */
    struct class_names classes; /* of all that may be drawn: images number them alike */
    struct swath_store store;
    struct mesh_store meshes; /* of scenes whose mesh_store it is */
};

/* Reads the scene that a plan describes. scene: initialised and empty; on failure it is left empty.
 * Errors: as sonject_scene_read, with the place in the campaign file where that says it. */
sonject_status campaign_read_scene(struct sonject_campaign *campaign, const struct image_plan *plan,
                                   struct scene *scene);

/* Opens and measures the swaths, splits them, tries scenes with all that may be drawn, and makes
 * the campaign's hash. Errors: INPUT, STORAGE, UNSUPPORTED, MEMORY. */
sonject_status campaign_check(struct sonject_campaign *campaign);

/* Whether the campaign has an image of that id. Errors: ARGUMENT. */
sonject_status campaign_check_id(const struct sonject_campaign *campaign, uint64_t id);

/* An image as it is made. Starts as all zeros, is for campaign_image_clear. */
struct campaign_image {
    struct image_plan plan;
    struct scene scene;
    struct swath swath;
    struct injection_result result;
};

/* Plans the image, reads its scene and its part of the swath, and injects. Errors: as
 * sonject_campaign_inject; the message names the image. */
sonject_status campaign_image_make(struct device *device, struct sonject_campaign *campaign,
                                   uint64_t id, sonject_progress_function progress, void *user,
                                   struct campaign_image *image);
void campaign_image_clear(struct campaign_image *image);

/* Writes the image's files below the folder, its record last. Errors: STORAGE, MEMORY,
 * UNSUPPORTED. */
sonject_status campaign_image_write(struct sonject_campaign *campaign, struct campaign_image *image,
                                    const char *folder);

/* The images that the folder lacks, of those that params asks for, and the documents of the whole:
 * sonject_campaign_run. */
sonject_status campaign_run(struct sonject_campaign *campaign, struct device_slot *slot,
                            const sonject_campaign_run_params *params,
                            sonject_progress_function progress, void *user, int *was_finished);

/* Those documents, once all images are there: sonject_campaign_merge. */
sonject_status campaign_merge(struct report *report, const char *folder,
                              sonject_progress_function progress, void *user);

#endif
