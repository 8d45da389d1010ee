/* Distributions as campaign files write them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "dataset/distribution.h"
#include "schema/scene_fields.h"
#include "schema/yaml_tree.h"

#define STEPS_MAX 1000000

static const char *const kinds[] = {"uniform", "log_uniform", "normal", "choice", "fixed"};

/* A number with the unit behind it, which all numbers of a distribution share. */
static sonject_status read_number(struct reader *reader, const struct tree_node *node,
                                  struct distribution *distribution, bool is_first, double *number)
{
    char excerpt[40];
    const char *rest;
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (!text_to_number(text, number, &rest) || !isfinite(*number))
        return refuse_value(reader, node, "'%s' is not a finite number, which a unit may follow",
                            text_excerpt(excerpt, sizeof excerpt, text));
    while (*rest == ' ' || *rest == '\t')
        rest++;
    char unit[sizeof distribution->unit] = "";
    if (strlen(rest) + 2 > sizeof unit)
        return refuse_value(reader, node, "'%s' is no unit",
                            text_excerpt(excerpt, sizeof excerpt, rest));
    if (*rest)
        snprintf(unit, sizeof unit, " %s", rest);
    if (!is_first && strcmp(unit, distribution->unit) != 0)
        return refuse_value(reader, node, "needs the same unit as the first number,%s%s",
                            *distribution->unit ? distribution->unit : " none", "");
    memcpy(distribution->unit, unit, sizeof unit);
    return SONJECT_OK;
}

static sonject_status check_limits(struct reader *reader, const struct tree_node *node,
                                   const struct distribution *distribution)
{
    if (!(distribution->low <= distribution->high))
        return refuse_value(reader, node, "begins at %g, which is above its end, %g; swap them",
                            distribution->low, distribution->high);
    if (!isfinite(distribution->high - distribution->low))
        return refuse_value(reader, node, "is too wide");
    if (distribution->kind == DISTRIBUTION_LOG_UNIFORM && !(distribution->low > 0.0))
        return refuse_value(reader, node, "must begin above 0, not at %g", distribution->low);
    return SONJECT_OK;
}

static sonject_status read_limits(struct reader *reader, const struct tree_node *node,
                                  struct distribution *distribution)
{
    if (node->kind != TREE_LIST || node->count != 2)
        return refuse_value(reader, node, "must be two numbers, [lowest, highest]");
    sonject_status status =
        read_number(reader, &node->entries[0].value, distribution, true, &distribution->low);
    THEN(status,
         read_number(reader, &node->entries[1].value, distribution, false, &distribution->high));
    return status == SONJECT_OK ? check_limits(reader, node, distribution) : status;
}

struct normal_numbers {
    const struct tree_node *nodes[4];
};

#define NORMAL_NUMBER(number) .kind = FIELD_SPECIAL, .read = number
static sonject_status keep_node(struct normal_numbers *numbers, int index,
                                const struct tree_node *node)
{
    numbers->nodes[index] = node;
    return SONJECT_OK;
}
#define KEEP(name, index)                                                                          \
    static sonject_status name(struct reader *reader, const struct tree_node *node,                \
                               void *structure)                                                    \
    {                                                                                              \
        (void)reader;                                                                              \
        return keep_node(structure, index, node);                                                  \
    }
KEEP(keep_mean, 0)
KEEP(keep_deviation, 1)
KEEP(keep_minimum, 2)
KEEP(keep_maximum, 3)

static const struct field normal_fields[] = {
    {"mean", "of the normal distribution before it is cut off", NORMAL_NUMBER(keep_mean), REQUIRED},
    {"deviation", "its standard deviation", NORMAL_NUMBER(keep_deviation), REQUIRED},
    {"minimum", "nothing is drawn below it", NORMAL_NUMBER(keep_minimum)},
    {"maximum", "nothing is drawn above it", NORMAL_NUMBER(keep_maximum)},
};
static const struct section normal_section = {normal_fields, COUNT(normal_fields), NULL};

/* Without limits of its own a normal distribution ends ten deviations from its mean. */
static sonject_status read_normal(struct reader *reader, const struct tree_node *node,
                                  struct distribution *distribution)
{
    struct normal_numbers numbers = {{NULL, NULL, NULL, NULL}};
    double *values[] = {&distribution->mean, &distribution->deviation, &distribution->low,
                        &distribution->high};
    sonject_status status = read_section(reader, &normal_section, node, &numbers);
    for (int i = 0; status == SONJECT_OK && i < 4; i++) {
        if (i == 2) {
            distribution->low = distribution->mean - 10.0 * distribution->deviation;
            distribution->high = distribution->mean + 10.0 * distribution->deviation;
        }
        if (!numbers.nodes[i])
            continue;
        const size_t before = key_path_add(&reader->path, normal_fields[i].key);
        status = read_number(reader, numbers.nodes[i], distribution, i == 0, values[i]);
        if (status == SONJECT_OK && i == 1 && !(distribution->deviation > 0.0))
            status = refuse_value(reader, numbers.nodes[i], "must be above 0");
        key_path_shorten(&reader->path, before);
    }
    THEN(status, check_limits(reader, node, distribution));
    if (status != SONJECT_OK)
        return status;
    const double a = (distribution->low - distribution->mean) / distribution->deviation;
    const double b = (distribution->high - distribution->mean) / distribution->deviation;
    if (!isfinite(a) || !isfinite(b) || a > 10.0 || b < -10.0)
        return refuse_value(reader, node,
                            "draws nothing: minimum and maximum lie more than ten deviations from "
                            "the mean");
    return SONJECT_OK;
}

static sonject_status keep_text(struct reader *reader, const struct tree_node *node,
                                struct distribution *distribution)
{
    char *text;
    if (tree_is_null(node))
        return refuse_value(reader, node, "has no value");
    const sonject_status status = tree_override_text(reader->report, node, &text);
    if (status == SONJECT_OK)
        distribution->texts[distribution->count++] = text;
    return status;
}

static sonject_status make_room(struct reader *reader, struct distribution *distribution,
                                size_t count)
{
    distribution->texts = allocate_array(count, sizeof *distribution->texts);
    distribution->cumulative = allocate_array(count, sizeof *distribution->cumulative);
    return distribution->texts && distribution->cumulative
               ? SONJECT_OK
               : report_out_of_memory(reader->report, "the campaign");
}

static sonject_status read_choice(struct reader *reader, const struct tree_node *node,
                                  struct distribution *distribution)
{
    if (node->kind != TREE_LIST || node->count == 0)
        return refuse_value(reader, node, "must be a list of values, one at least");
    sonject_status status = make_room(reader, distribution, node->count);
    for (size_t i = 0; status == SONJECT_OK && i < node->count; i++) {
        const size_t before = key_path_add_index(&reader->path, i);
        status = keep_text(reader, &node->entries[i].value, distribution);
        distribution->cumulative[i] = (double)(i + 1) / (double)node->count;
        key_path_shorten(&reader->path, before);
    }
    return status;
}

static sonject_status read_weights(struct reader *reader, const struct tree_node *node,
                                   struct distribution *distribution)
{
    double sum = 0.0;
    if (node->kind != TREE_LIST || node->count != distribution->count)
        return refuse_value(reader, node, "must be a list of %zu numbers, one a choice",
                            distribution->count);
    for (size_t i = 0; i < node->count; i++) {
        double weight;
        CHECK(read_quantity(reader, &node->entries[i].value, QUANTITY_NUMBER, &weight));
        if (!(weight >= 0.0 && weight <= 1e9))
            return refuse_value(reader, &node->entries[i].value, "must be from 0 to 1e9");
        sum += weight;
        distribution->cumulative[i] = sum;
    }
    if (!(sum > 0.0))
        return refuse_value(reader, node, "are all 0");
    for (size_t i = 0; i < node->count; i++)
        distribution->cumulative[i] /= sum;
    return SONJECT_OK;
}

static sonject_status read_steps(struct reader *reader, const struct tree_node *node,
                                 struct distribution *distribution)
{
    uint64_t steps;
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (!text_to_count(text, &steps) || steps < 1 || steps > STEPS_MAX)
        return refuse_value(reader, node, "must be a whole number from 1 to %d", STEPS_MAX);
    distribution->steps = (uint32_t)steps;
    return SONJECT_OK;
}

static sonject_status read_kind(struct reader *reader, const struct tree_node *node,
                                struct distribution *distribution)
{
    static const enum distribution_kind of_words[] = {DISTRIBUTION_UNIFORM,
                                                      DISTRIBUTION_LOG_UNIFORM, DISTRIBUTION_NORMAL,
                                                      DISTRIBUTION_CHOICE, DISTRIBUTION_FIXED};
    size_t kind = 0;
    while (kind < COUNT(kinds) && !tree_find(node, kinds[kind]))
        kind++;
    const struct tree_entry *entry = tree_find(node, kinds[kind]);
    distribution->kind = of_words[kind];
    const size_t before = key_path_add(&reader->path, entry->key);
    sonject_status status;
    if (distribution->kind == DISTRIBUTION_CHOICE) {
        status = read_choice(reader, &entry->value, distribution);
    } else if (distribution->kind == DISTRIBUTION_NORMAL) {
        status = read_normal(reader, &entry->value, distribution);
    } else if (distribution->kind == DISTRIBUTION_FIXED) {
        status = make_room(reader, distribution, 1);
        THEN(status, keep_text(reader, &entry->value, distribution));
    } else {
        status = read_limits(reader, &entry->value, distribution);
    }
    key_path_shorten(&reader->path, before);
    return status;
}

/* What may stand beside the kind. */
static sonject_status read_rest(struct reader *reader, const struct tree_node *node,
                                struct distribution *distribution)
{
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        const bool is_choice = distribution->kind == DISTRIBUTION_CHOICE;
        const bool is_range = distribution->kind == DISTRIBUTION_UNIFORM ||
                              distribution->kind == DISTRIBUTION_LOG_UNIFORM;
        sonject_status status = SONJECT_OK;
        const size_t before = key_path_add(&reader->path, entry->key);
        if (is_choice && strcmp(entry->key, "weights") == 0)
            status = read_weights(reader, &entry->value, distribution);
        else if (is_range && strcmp(entry->key, "steps") == 0)
            status = read_steps(reader, &entry->value, distribution);
        else if (!(distribution->kind == DISTRIBUTION_UNIFORM &&
                   strcmp(entry->key, "uniform") == 0) &&
                 !(distribution->kind == DISTRIBUTION_LOG_UNIFORM &&
                   strcmp(entry->key, "log_uniform") == 0) &&
                 !(distribution->kind == DISTRIBUTION_NORMAL &&
                   strcmp(entry->key, "normal") == 0) &&
                 !(is_choice && strcmp(entry->key, "choice") == 0) &&
                 !(distribution->kind == DISTRIBUTION_FIXED && strcmp(entry->key, "fixed") == 0))
            status = refuse_value(reader, &entry->value, "does not belong here; remove it");
        key_path_shorten(&reader->path, before);
        if (status != SONJECT_OK)
            return status;
    }
    return SONJECT_OK;
}

static sonject_status refuse_kind(struct reader *reader, const struct tree_node *node)
{
    struct word_list list = {{0}, 0};
    const char *near = NULL;
    for (size_t i = 0; i < COUNT(kinds); i++)
        list_word(&list, kinds[i]);
    if (node->count > 0)
        near = nearest_word(node->entries[0].key, kinds, COUNT(kinds));
    return refuse_value(reader, node, "needs one of %s%s%s%s; a section is {fixed: {...}}",
                        list.text, near ? "; did you mean '" : "", near ? near : "",
                        near ? "'?" : "");
}

sonject_status distribution_read(struct reader *reader, const struct tree_node *node,
                                 const char *key, struct distribution *distribution)
{
    distribution->place = node->place;
    distribution->key = copy_text(key);
    CHECK_MEMORY(reader->report, distribution->key, "the campaign");
    if (node->kind != TREE_SECTION) {
        distribution->kind = DISTRIBUTION_FIXED;
        CHECK(make_room(reader, distribution, 1));
        return keep_text(reader, node, distribution);
    }
    size_t known = 0;
    for (size_t i = 0; i < COUNT(kinds); i++)
        known += tree_find(node, kinds[i]) != NULL;
    if (known != 1)
        return refuse_kind(reader, node);
    CHECK(read_kind(reader, node, distribution));
    return read_rest(reader, node, distribution);
}
