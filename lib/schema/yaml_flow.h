/* Parts of a tree as text again. */
#ifndef SONJECT_SCHEMA_YAML_FLOW_H
#define SONJECT_SCHEMA_YAML_FLOW_H

#include "base/growing_text.h"
#include "schema/yaml_tree.h"

/* Adds the node in YAML's flow style, on one line, so that reading it gives the same tree. */
void tree_write_flow(const struct tree_node *node, struct growing_text *text);

/* The node as the value of an override. *text is for free(). Errors: MEMORY. */
sonject_status tree_override_text(struct report *report, const struct tree_node *node, char **text);

#endif
