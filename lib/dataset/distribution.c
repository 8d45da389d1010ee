/* The sources of drawn values: counter-based random numbers, permutations, shares of whole things,
 * and distributions as campaign files write them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign.h"
#include "kernels/random.h"
#include "schema/keys.h"

#define FEISTEL_ROUNDS 8
#define STEPS_MAX      1000000
#define ROOT_HALF      0.70710678118654752440

/* First streams of a permutation's own numbers, above the streams of callers. */
#define JITTER_STREAMS 0x40000000u
#define ROUND_STREAMS  0x80000000u

static uint64_t random_bits(uint64_t seed, uint32_t stream, uint64_t index)
{
    const struct random_key key =
        random_key_of((uint32_t)seed, (uint32_t)(seed >> 32), stream, (uint32_t)(index >> 32));
    uint32_t high = (uint32_t)index;
    uint32_t low = 0;
    threefry_scalar(key.first, key.second, &high, &low);
    return (uint64_t)high << 32 | low;
}

double uniform_number(uint64_t seed, uint32_t stream, uint64_t index)
{
    return ((double)(random_bits(seed, stream, index) >> 12) + 0.5) * 0x1p-52;
}

/* Runs a Feistel network on 2^(2 half_bits) numbers. Results beyond count are sent through again
 * until they are below count, fewer than four times on average. */
uint64_t permuted_index(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count)
{
    unsigned half_bits = 1;
    while (half_bits < 32 && (UINT64_C(1) << (2 * half_bits)) < count)
        half_bits++;
    const uint64_t low_bits = (UINT64_C(1) << half_bits) - 1;
    do {
        uint64_t left = index >> half_bits;
        uint64_t right = index & low_bits;
        for (uint32_t round = 0; round < FEISTEL_ROUNDS; round++) {
            const uint64_t mixed =
                random_bits(seed, ROUND_STREAMS | stream, (uint64_t)round << 40 | right);
            const uint64_t next = left ^ (mixed & low_bits);
            left = right;
            right = next;
        }
        index = left << half_bits | right;
    } while (index >= count);
    return index;
}

double stratified_number(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count)
{
    const uint64_t stratum = permuted_index(seed, stream, index, count);
    const double within = uniform_number(seed, JITTER_STREAMS | stream, index);
    return fmin(((double)stratum + within) / (double)count, 1.0 - 0x1p-53);
}

void share_out(uint64_t total, const double *weights, size_t count, uint64_t *shares)
{
    double sum = 0.0;
    uint64_t given = 0;
    for (size_t i = 0; i < count; i++)
        sum += weights[i];
    for (size_t i = 0; i < count; i++) {
        shares[i] = (uint64_t)floor((double)total * (weights[i] / sum));
        given += shares[i];
    }
    /* for very large totals, rounding may have given one too many */
    for (size_t i = 0; given > total && i < count; i++)
        if (shares[i] > 0) {
            shares[i]--;
            given--;
        }
    while (given < total) {
        size_t best = 0;
        double most = -2.0;
        for (size_t i = 0; i < count; i++) {
            const double left = (double)total * (weights[i] / sum) - (double)shares[i];
            if (weights[i] > 0.0 && left > most + 1e-9) {
                most = left;
                best = i;
            }
        }
        shares[best]++;
        given++;
    }
}

/* Returns the mass of the standard normal distribution between low and high. Tails are measured
 * from their own side, where they have their digits. */
static double mass_between(double low, double high)
{
    if (low > 0.0)
        return 0.5 * (erfc(low * ROOT_HALF) - erfc(high * ROOT_HALF));
    return 0.5 * (erfc(-high * ROOT_HALF) - erfc(-low * ROOT_HALF));
}

/* Finds a quantile of the cut normal distribution by bisection, to the last written digits. */
static double normal_quantile(double low, double high, double u)
{
    const double mass = u * mass_between(low, high);
    double below = low;
    double above = high;
    for (int i = 0; i < 100 && below < above; i++) {
        const double middle = 0.5 * (below + above);
        if (mass_between(low, middle) < mass)
            below = middle;
        else
            above = middle;
    }
    return 0.5 * (below + above);
}

double distribution_number(const struct distribution *distribution, double u)
{
    const double low = distribution->low;
    const double high = distribution->high;
    double number = low + u * (high - low);
    if (distribution->kind == DISTRIBUTION_LOG_UNIFORM)
        number = low * pow(high / low, u);
    if (distribution->kind == DISTRIBUTION_NORMAL)
        number = distribution->mean +
                 distribution->deviation *
                     normal_quantile((low - distribution->mean) / distribution->deviation,
                                     (high - distribution->mean) / distribution->deviation, u);
    return fmin(fmax(number, low), high);
}

/* Writes a number with nine digits, which hide differences in the last bits between machines. A
 * rounded number may lie beyond the limits by a billionth; then it is written in full. */
static const char *write_number(const struct distribution *distribution, double number,
                                char text[DISTRIBUTION_TEXT_CAPACITY])
{
    char digits[32];
    double read = number;
    const char *rest;
    text_of_number(digits, sizeof digits, number, 9);
    text_to_number(digits, &read, &rest);
    if (read < distribution->low || read > distribution->high)
        text_of_number(digits, sizeof digits, number, 17);
    snprintf(text, DISTRIBUTION_TEXT_CAPACITY, "%s%s", digits, distribution->unit);
    return text;
}

const char *distribution_value(const struct distribution *distribution, double u,
                               char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->kind == DISTRIBUTION_FIXED)
        return distribution->texts[0];
    if (distribution->kind != DISTRIBUTION_CHOICE)
        return write_number(distribution, distribution_number(distribution, u), text);
    size_t chosen = 0;
    while (chosen + 1 < distribution->count && u >= distribution->cumulative[chosen])
        chosen++;
    return distribution->texts[chosen];
}

uint32_t distribution_steps(const struct distribution *distribution)
{
    if (distribution->kind != DISTRIBUTION_CHOICE)
        return distribution->steps;
    for (size_t i = 0; i < distribution->count; i++)
        if (fabs(distribution->cumulative[i] - (double)(i + 1) / (double)distribution->count) >
            1e-12)
            return 0;
    return (uint32_t)distribution->count;
}

const char *distribution_step(const struct distribution *distribution, uint32_t step,
                              char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->kind == DISTRIBUTION_CHOICE)
        return distribution->texts[step];
    const double u =
        distribution->steps > 1 ? (double)step / (double)(distribution->steps - 1) : 0.5;
    return write_number(distribution, distribution_number(distribution, u), text);
}

/* Reads a number with its unit, which all numbers of a distribution share. */
static sonject_status read_number(struct reader *reader, const struct tree_node *node,
                                  struct distribution *distribution, bool is_first, double *number)
{
    char excerpt[40];
    char unit[sizeof distribution->unit] = "";
    const char *rest;
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (!text_to_number(text, number, &rest) || !isfinite(*number))
        return refuse_value(reader, node, "'%s' is not a finite number, with or without a unit",
                            text_excerpt(excerpt, sizeof excerpt, text));
    rest += strspn(rest, " \t");
    if (strlen(rest) + 2 > sizeof unit)
        return refuse_value(reader, node, "'%s' is not a unit",
                            text_excerpt(excerpt, sizeof excerpt, rest));
    if (*rest)
        snprintf(unit, sizeof unit, " %s", rest);
    if (!is_first && strcmp(unit, distribution->unit) != 0)
        return refuse_value(reader, node, "needs the same unit as the first number,%s",
                            *distribution->unit ? distribution->unit : " none");
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
    CHECK(read_number(reader, &node->entries[0].value, distribution, true, &distribution->low));
    CHECK(read_number(reader, &node->entries[1].value, distribution, false, &distribution->high));
    return check_limits(reader, node, distribution);
}

#define LATER .kind = FIELD_SPECIAL /* read once all are there, since all share a unit */
static const struct field normal_fields[] = {
    {"mean", "mean of the normal distribution before it is cut off", LATER, REQUIRED},
    {"deviation", "standard deviation of the normal distribution", LATER, REQUIRED},
    {"minimum", "least value that is drawn", LATER},
    {"maximum", "greatest value that is drawn", LATER},
};
static const struct section normal_section = {ROWS(normal_fields)};

/* Reads a normal distribution. Without given limits, it ends ten deviations from its mean. */
static sonject_status read_normal(struct reader *reader, const struct tree_node *node,
                                  struct distribution *distribution)
{
    double *values[] = {&distribution->mean, &distribution->deviation, &distribution->low,
                        &distribution->high};
    sonject_status status = read_section(reader, &normal_section, node, distribution);
    for (int i = 0; status == SONJECT_OK && i < 4; i++) {
        const struct tree_entry *entry = tree_find(node, normal_fields[i].key);
        if (i >= 2)
            *values[i] = distribution->mean + (i == 2 ? -10.0 : 10.0) * distribution->deviation;
        if (!entry)
            continue;
        const size_t before = key_path_add(&reader->path, entry->key);
        status = read_number(reader, &entry->value, distribution, i == 0, values[i]);
        if (status == SONJECT_OK && i == 1 && !(distribution->deviation > 0.0))
            status = refuse_value(reader, &entry->value, "must be above 0");
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

static sonject_status make_room(struct reader *reader, struct distribution *distribution,
                                size_t count)
{
    distribution->texts = allocate_array(count, sizeof *distribution->texts);
    distribution->cumulative = allocate_array(count, sizeof *distribution->cumulative);
    CHECK_MEMORY(reader->report, distribution->texts && distribution->cumulative, "the campaign");
    return SONJECT_OK;
}

static sonject_status keep_text(struct reader *reader, const struct tree_node *node,
                                struct distribution *distribution)
{
    if (tree_is_null(node))
        return refuse_value(reader, node, "has no value");
    CHECK(tree_override_text(reader->report, node, &distribution->texts[distribution->count]));
    distribution->count++;
    return SONJECT_OK;
}

static sonject_status read_fixed(struct reader *reader, const struct tree_node *node,
                                 struct distribution *distribution)
{
    CHECK(make_room(reader, distribution, 1));
    return keep_text(reader, node, distribution);
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

static sonject_status read_of(struct reader *reader, const struct tree_node *node,
                              struct distribution *distribution)
{
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (*distribution->unit)
        return refuse_value(reader, node, "makes the numbers ratios, which must have no unit");
    distribution->of = copy_text(text);
    CHECK_MEMORY(reader->report, distribution->of, "the campaign");
    return SONJECT_OK;
}

typedef sonject_status read_function(struct reader *reader, const struct tree_node *node,
                                     struct distribution *distribution);

/* The word and reader of each kind, and of the key that may stand beside it. */
static const struct {
    const char *word;
    read_function *read;
    const char *beside; /* NULL: nothing */
    read_function *read_beside;
} kinds[] = {[DISTRIBUTION_UNIFORM] = {"uniform", read_limits, "steps", read_steps},
             [DISTRIBUTION_LOG_UNIFORM] = {"log_uniform", read_limits, "steps", read_steps},
             [DISTRIBUTION_NORMAL] = {"normal", read_normal, NULL, NULL},
             [DISTRIBUTION_CHOICE] = {"choice", read_choice, "weights", read_weights},
             [DISTRIBUTION_FIXED] = {"fixed", read_fixed, NULL, NULL}};

static sonject_status refuse_kind(struct reader *reader, const struct tree_node *node,
                                  const char *key)
{
    struct word_list list = {{0}, 0};
    const char *words[COUNT(kinds)], *unused;
    const struct section *section;
    char path[REPORT_LINE];
    snprintf(path, sizeof path, "%s.%s", key, node->count > 0 ? node->entries[0].key : "");
    if (scene_key_find(&object_section, path, &unused, &section) ||
        scene_key_find(&scene_section, path, &unused, &section))
        return refuse_value(reader, node, "is a section: draw its keys, such as %s: {uniform: ...}",
                            path);
    for (size_t i = 0; i < COUNT(kinds); i++)
        list_word(&list, words[i] = kinds[i].word);
    const char *near =
        node->count > 0 ? nearest_word(node->entries[0].key, words, COUNT(kinds)) : NULL;
    return refuse_value(reader, node, "needs one of %s%s%s%s; a section is {fixed: {...}}",
                        list.text, near ? "; did you mean '" : "", near ? near : "",
                        near ? "'?" : "");
}

/* Reads the key that names the kind, or all other keys. */
static sonject_status read_keys(struct reader *reader, const struct tree_node *node,
                                struct distribution *distribution, bool names_kind)
{
    const enum distribution_kind kind = distribution->kind;
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        if ((strcmp(entry->key, kinds[kind].word) == 0) != names_kind)
            continue;
        const size_t before = key_path_add(&reader->path, entry->key);
        if (names_kind)
            status = kinds[kind].read(reader, &entry->value, distribution);
        else if (kinds[kind].beside && strcmp(entry->key, kinds[kind].beside) == 0)
            status = kinds[kind].read_beside(reader, &entry->value, distribution);
        else if (kind <= DISTRIBUTION_NORMAL && strcmp(entry->key, "of") == 0)
            status = read_of(reader, &entry->value, distribution);
        else
            status = refuse_value(reader, &entry->value, "does not belong here; remove it");
        key_path_shorten(&reader->path, before);
    }
    return status;
}

sonject_status distribution_read(struct reader *reader, const struct tree_node *node,
                                 const char *key, struct distribution *distribution)
{
    size_t known = 0;
    distribution->place = node->place;
    distribution->kind = DISTRIBUTION_FIXED;
    distribution->key = copy_text(key);
    CHECK_MEMORY(reader->report, distribution->key, "the campaign");
    if (node->kind != TREE_SECTION)
        return read_fixed(reader, node, distribution);
    for (size_t i = 0; i < COUNT(kinds); i++)
        if (tree_find(node, kinds[i].word)) {
            distribution->kind = (enum distribution_kind)i;
            known++;
        }
    if (known != 1)
        return refuse_kind(reader, node, key);
    CHECK(read_keys(reader, node, distribution, true));
    return read_keys(reader, node, distribution, false);
}

void distribution_clear(struct distribution *distribution)
{
    for (size_t i = 0; distribution->texts && i < distribution->count; i++)
        free(distribution->texts[i]);
    free(distribution->texts);
    free(distribution->cumulative);
    if (distribution->table)
        body_table_clear(distribution->table, distribution->count);
    free(distribution->key);
    free(distribution->of);
    memset(distribution, 0, sizeof *distribution);
}
