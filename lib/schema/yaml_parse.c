/* The parser that builds a tree from libyaml's events. */
#include <string.h>

#include <yaml.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "schema/yaml_tree.h"

struct builder {
    struct tree *tree;
    const char *override; /* NULL: a file is parsed */
    const char *text;
    yaml_parser_t parser;
    struct key_path path;
};

static struct tree_place place_of(const struct builder *builder, yaml_mark_t mark)
{
    const struct tree_place place = {builder->override, mark.line + 1, mark.column + 1};
    return place;
}

/* Finds the place of a byte that is not text, of which libyaml gives only the offset. */
static struct tree_place place_of_offset(const struct builder *builder, size_t offset)
{
    struct tree_place place = {builder->override, 1, 1};
    for (size_t i = 0; i < offset; i++) {
        const unsigned char byte = (unsigned char)builder->text[i];
        if (byte == '\n') {
            place.line++;
            place.column = 1;
        } else if ((byte & 0xC0) != 0x80) {
            place.column++;
        }
    }
    return place;
}

static sonject_status refuse(const struct builder *builder, const yaml_event_t *event,
                             const char *what)
{
    return tree_failure(builder->tree, place_of(builder, event->start_mark), builder->path.text,
                        "%s", what);
}

static sonject_status explain_parser(const struct builder *builder)
{
    const yaml_parser_t *parser = &builder->parser;
    const char *problem = parser->problem ? parser->problem : "unknown problem";
    if (parser->error == YAML_MEMORY_ERROR)
        return report_out_of_memory(builder->tree->report, "the scene file");
    if (parser->error == YAML_READER_ERROR)
        return tree_failure(builder->tree, place_of_offset(builder, parser->problem_offset),
                            builder->path.text, "not UTF-8 text (%s); save the file as UTF-8",
                            problem);
    return tree_failure(builder->tree, place_of(builder, parser->problem_mark), builder->path.text,
                        "not valid YAML (%s%s%s); check indentation, colons, quotes and brackets",
                        parser->context ? parser->context : "", parser->context ? ": " : "",
                        problem);
}

/* Gets the next event. On success the event is the caller's, for yaml_event_delete. */
static sonject_status next_event(struct builder *builder, yaml_event_t *event)
{
    if (yaml_parser_parse(&builder->parser, event))
        return SONJECT_OK;
    return explain_parser(builder);
}

static sonject_status build_node(struct builder *builder, const yaml_event_t *event, int depth,
                                 struct tree_node *node);

static sonject_status copy_scalar(const struct builder *builder, const yaml_event_t *event,
                                  char **text)
{
    const char *value = (const char *)event->data.scalar.value;
    if (strlen(value) != event->data.scalar.length)
        return refuse(builder, event, "contains a character 0; remove it");
    *text = copy_text(value);
    return *text ? SONJECT_OK : report_out_of_memory(builder->tree->report, "the scene file");
}

static sonject_status take_key(struct builder *builder, const yaml_event_t *event,
                               struct tree_node *node, struct tree_entry **entry)
{
    if (event->type != YAML_SCALAR_EVENT || event->data.scalar.tag || event->data.scalar.anchor)
        return refuse(builder, event, "keys must be plain words; write 'key: value'");
    const char *key = (const char *)event->data.scalar.value;
    if (strlen(key) != event->data.scalar.length)
        return refuse(builder, event, "the key contains a character 0; remove it");
    const struct tree_entry *earlier = tree_find(node, key);
    key_path_add(&builder->path, key);
    if (earlier) {
        tree_failure(builder->tree, place_of(builder, event->start_mark), builder->path.text,
                     "given twice, first on line %zu; remove one", earlier->place.line);
        if (!builder->tree->mistakes)
            return SONJECT_ERROR_INPUT;
    }
    return tree_append(builder->tree, node, &builder->path, key,
                       place_of(builder, event->start_mark), entry);
}

static sonject_status build_value(struct builder *builder, int depth, struct tree_node *node)
{
    yaml_event_t event;
    CHECK(next_event(builder, &event));
    const sonject_status status = build_node(builder, &event, depth, node);
    yaml_event_delete(&event);
    return status;
}

/* Builds a list's or section's entries, to its end. After a failure the path stays where it was. */
static sonject_status build_entries(struct builder *builder, enum tree_kind kind, int depth,
                                    struct tree_node *node)
{
    const bool is_list = kind == TREE_LIST;
    const yaml_event_type_t end = is_list ? YAML_SEQUENCE_END_EVENT : YAML_MAPPING_END_EVENT;
    node->kind = kind;
    for (;;) {
        yaml_event_t event;
        struct tree_entry *entry;
        const size_t before = builder->path.length;
        CHECK(next_event(builder, &event));
        const bool is_over = event.type == end;
        sonject_status status = SONJECT_OK;
        if (is_list && !is_over) {
            key_path_add_index(&builder->path, node->count);
            status = tree_append(builder->tree, node, &builder->path, NULL,
                                 place_of(builder, event.start_mark), &entry);
            THEN(status, build_node(builder, &event, depth + 1, &entry->value));
        } else if (!is_over) {
            status = take_key(builder, &event, node, &entry);
            THEN(status, build_value(builder, depth + 1, &entry->value));
        }
        yaml_event_delete(&event);
        if (is_over || status != SONJECT_OK)
            return status;
        key_path_shorten(&builder->path, before);
    }
}

static sonject_status build_node(struct builder *builder, const yaml_event_t *event, int depth,
                                 struct tree_node *node)
{
    static const char no_marks[] = "anchors and tags (&name, !name) are not supported; remove it";
    node->place = place_of(builder, event->start_mark);
    if (depth > TREE_DEPTH_MAX)
        return refuse(builder, event, "nested too deeply; no scene needs this many levels");
    switch (event->type) {
    case YAML_SCALAR_EVENT:
        if (event->data.scalar.anchor || event->data.scalar.tag)
            return refuse(builder, event, no_marks);
        node->kind = TREE_TEXT;
        node->is_quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
        return copy_scalar(builder, event, &node->text);
    case YAML_SEQUENCE_START_EVENT:
        if (event->data.sequence_start.anchor || event->data.sequence_start.tag)
            return refuse(builder, event, no_marks);
        return build_entries(builder, TREE_LIST, depth, node);
    case YAML_MAPPING_START_EVENT:
        if (event->data.mapping_start.anchor || event->data.mapping_start.tag)
            return refuse(builder, event, no_marks);
        return build_entries(builder, TREE_SECTION, depth, node);
    default:
        return refuse(builder, event, "aliases (*name) are not supported; write the value out");
    }
}

static sonject_status expect(struct builder *builder, yaml_event_type_t type, const char *otherwise)
{
    yaml_event_t event;
    CHECK(next_event(builder, &event));
    const sonject_status status =
        event.type == type ? SONJECT_OK : refuse(builder, &event, otherwise);
    yaml_event_delete(&event);
    return status;
}

static sonject_status build_document(struct builder *builder, int depth, struct tree_node *node)
{
    sonject_status status = expect(builder, YAML_STREAM_START_EVENT, "not YAML");
    THEN(status, expect(builder, YAML_DOCUMENT_START_EVENT, "there is nothing in it"));
    THEN(status, build_value(builder, depth, node));
    THEN(status, expect(builder, YAML_DOCUMENT_END_EVENT, "something follows the document"));
    THEN(status, expect(builder, YAML_STREAM_END_EVENT,
                        "a second document starts here; keep one in a file"));
    return status;
}

static sonject_status parse(struct builder *builder, size_t bytes, int depth,
                            struct tree_node *node)
{
    if (!yaml_parser_initialize(&builder->parser))
        return report_out_of_memory(builder->tree->report, "the YAML parser");
    yaml_parser_set_encoding(&builder->parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&builder->parser, (const unsigned char *)builder->text, bytes);
    const sonject_status status = build_document(builder, depth, node);
    yaml_parser_delete(&builder->parser);
    return status;
}

sonject_status tree_parse(struct tree *tree, const char *text, size_t bytes)
{
    static const char byte_order_mark[] = "\xEF\xBB\xBF";
    if (bytes > TREE_BYTES_MAX)
        return input_failure(tree->report, tree->file,
                             "larger than %d bytes; this is no scene file", TREE_BYTES_MAX);
    /* libyaml skips the byte-order mark only where it chooses the encoding itself. */
    const size_t skipped = bytes >= 3 && memcmp(text, byte_order_mark, 3) == 0 ? 3 : 0;
    struct builder builder = {.tree = tree, .text = text + skipped};
    return parse(&builder, bytes - skipped, 0, &tree->root);
}

sonject_status tree_parse_value(struct tree *tree, const char *override, const char *text,
                                int depth, struct tree_node *node)
{
    struct builder builder = {.tree = tree, .override = override, .text = text};
    text_excerpt(builder.path.text, sizeof builder.path.text, override);
    builder.path.length = strlen(builder.path.text);
    return parse(&builder, strlen(text), depth, node);
}
