#include "schema/yaml_flow.h"

#include <string.h>

static bool is_plain_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           (c && strchr("_./+-", c));
}

/* Fit to stand in flow style without quotes: words of letters, digits and a few signs. */
static bool is_plain(const char *text)
{
    const size_t length = strlen(text);
    if (length == 0 || !is_plain_character(text[length - 1]) || text[0] == '-' ||
        !is_plain_character(text[0]))
        return length > 1 && text[0] == '-' && is_plain(text + 1) && text[1] != ' ';
    for (size_t i = 0; i < length; i++)
        if (!is_plain_character(text[i]) && text[i] != ' ')
            return false;
    return true;
}

static void write_quoted(const char *text, struct growing_text *out)
{
    growing_text_add(out, "\"");
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            growing_text_add(out, "\\%c", c);
        else if (c < 0x20 || c == 0x7F)
            growing_text_add(out, "\\x%02X", c);
        else
            growing_text_add(out, "%c", c);
    }
    growing_text_add(out, "\"");
}

void tree_write_flow(const struct tree_node *node, struct growing_text *text)
{
    if (node->kind == TREE_TEXT) {
        const struct tree_node unquoted = {.kind = TREE_TEXT, .text = node->text};
        if (tree_is_null(node))
            growing_text_add(text, "null");
        else if (is_plain(node->text) && !tree_is_null(&unquoted))
            growing_text_add(text, "%s", node->text);
        else
            write_quoted(node->text, text);
        return;
    }
    growing_text_add(text, node->kind == TREE_LIST ? "[" : "{");
    for (size_t i = 0; i < node->count; i++) {
        if (i > 0)
            growing_text_add(text, ", ");
        if (node->kind == TREE_SECTION) {
            write_quoted(node->entries[i].key, text);
            growing_text_add(text, ": ");
        }
        tree_write_flow(&node->entries[i].value, text);
    }
    growing_text_add(text, node->kind == TREE_LIST ? "]" : "}");
}

sonject_status tree_override_text(struct report *report, const struct tree_node *node, char **text)
{
    struct growing_text flow = {NULL, 0, 0, false};
    tree_write_flow(node, &flow);
    *text = growing_text_end(&flow);
    return *text ? SONJECT_OK : report_out_of_memory(report, "a value");
}
