/* Readers of parts of campaign files. */
#ifndef SONJECT_DATASET_CAMPAIGN_FIELDS_H
#define SONJECT_DATASET_CAMPAIGN_FIELDS_H

#include "dataset/campaign.h"
#include "schema/scene_fields.h"

/* The special readers of the tables; structure: the campaign. Draws of "objects[].heading" and the
 * like go to campaign->object_draws. */
sonject_status read_campaign_draws(struct reader *reader, const struct tree_node *node,
                                   void *structure);
sonject_status read_targets(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_clutter_objects(struct reader *reader, const struct tree_node *node,
                                    void *structure);
sonject_status read_clutter_number(struct reader *reader, const struct tree_node *node,
                                   void *structure);
sonject_status read_swaths(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_splits(struct reader *reader, const struct tree_node *node, void *structure);

/* Whether key, which entry's text is or ends with, is one of the scene (or of an object) that a
 * campaign may set. Errors: INPUT. */
sonject_status check_scene_key(struct reader *reader, const struct tree_entry *entry,
                               const char *key, bool is_object);

/* Gives *list, of count elements of size bytes, room for one more, which becomes all zeros. Errors:
 * MEMORY. */
sonject_status grow_list(struct report *report, void *list, size_t count, size_t size);

#endif
