/* The numbers of a campaign's file that a fit moves, and the text with new numbers in place. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"
#include "dataset/fit.h"

#define ALL_SIZES  (FITTED_BIT(FITTED_LENGTH) | FITTED_BIT(FITTED_WIDTH) | FITTED_BIT(FITTED_HEIGHT))
#define LEVEL_KEY  "level.over_seabed"
#define FLOOR_KEY  "injection.noise_floor"
#define RATIO_KEY  "range_over_altitude"
#define OF_OBJECTS "objects[]."

/* Returns the kinds of sizes that a key sets; 0: none that is moved. item: NULL for all objects. */
static uint32_t kinds_of_key(const char *key, const struct draws *draws, const struct item *item)
{
    static const struct {
        const char *key;
        uint32_t kinds;
    } sizes[] = {
        {"length", FITTED_BIT(FITTED_LENGTH)},       {"width", FITTED_BIT(FITTED_WIDTH)},
        {"height", FITTED_BIT(FITTED_HEIGHT)},       {"front_height", FITTED_BIT(FITTED_HEIGHT)},
        {"burial.proud", FITTED_BIT(FITTED_HEIGHT)}, {LEVEL_KEY, FITTED_BIT(FITTED_LEVEL)}};
    for (size_t i = 0; i < COUNT(sizes); i++)
        if (strcmp(key, sizes[i].key) == 0)
            return sizes[i].kinds;
    if (strcmp(key, "diameter") != 0 && strcmp(key, "top_diameter") != 0)
        return 0;
    /* a diameter sets the sizes that have no key of their own */
    uint32_t kinds = ALL_SIZES;
    for (size_t i = 0; i < 3; i++) {
        char quoted[32];
        snprintf(quoted, sizeof quoted, "\"%s\": ", sizes[i].key);
        if (draws_have_key(draws, sizes[i].key) || (item && strstr(item->object, quoted)))
            kinds &= ~sizes[i].kinds;
    }
    return kinds;
}

static sonject_status add_number(struct fit_draws *draws, struct report *report,
                                 const struct tree_node *node, const struct fitted_number *like,
                                 double value, bool is_deviation)
{
    if (node->place.override)
        return tree_failure(&draws->campaign->tree, node->place, like->key,
                            "is changed by the fit: write it into the campaign's file instead of "
                            "giving it by --set");
    CHECK(grow_list(report, &draws->numbers, draws->count, sizeof *draws->numbers, "the campaign"));
    struct fitted_number *number = &draws->numbers[draws->count++];
    *number = *like;
    number->node = node;
    number->start = number->value = value;
    number->is_deviation = is_deviation;
    return SONJECT_OK;
}

/* Adds the numbers of a distribution's list, "uniform: [low, high]" or "choice: [...]". */
static sonject_status add_list(struct fit_draws *draws, struct report *report,
                               const struct tree_node *list, struct fitted_number *like)
{
    for (size_t i = 0; i < list->count; i++) {
        const struct tree_node *node = &list->entries[i].value;
        const char *rest;
        double value;
        if (node->kind != TREE_TEXT || !node->text || !text_to_number(node->text, &value, &rest))
            return SONJECT_OK; /* a word */
        snprintf(like->unit, sizeof like->unit, "%s", rest);
        CHECK(add_number(draws, report, node, like, value, false));
    }
    return SONJECT_OK;
}

static sonject_status add_distribution(struct fit_draws *draws, struct report *report,
                                       const struct tree_node *node,
                                       const struct distribution *distribution,
                                       struct fitted_number *like)
{
    static const char *const lists[] = {"uniform", "log_uniform", "choice"};
    const struct tree_entry *normal = tree_find(node, "normal");
    const double normals[] = {distribution->mean, distribution->deviation, distribution->low,
                              distribution->high};
    static const char *const members[] = {"mean", "deviation", "minimum", "maximum"};
    memcpy(like->unit, distribution->unit, sizeof like->unit);
    for (size_t i = 0; i < COUNT(lists); i++) {
        const struct tree_entry *entry = tree_find(node, lists[i]);
        if (entry)
            CHECK(add_list(draws, report, &entry->value, like));
    }
    for (size_t i = 0; normal && i < COUNT(members); i++) {
        const struct tree_entry *entry = tree_find(&normal->value, members[i]);
        if (entry)
            CHECK(add_number(draws, report, &entry->value, like, normals[i], i == 1));
    }
    const struct tree_entry *fixed = tree_find(node, "fixed");
    const struct tree_node *value = fixed ? &fixed->value : node;
    const struct tree_node alone = {
        .kind = TREE_LIST, .count = 1, .entries = &(struct tree_entry){.value = *value}};
    if (value->kind == TREE_LIST)
        return add_list(draws, report, value, like);
    if (value->kind == TREE_TEXT) {
        const size_t before = draws->count;
        CHECK(add_list(draws, report, &alone, like));
        for (size_t i = before; i < draws->count; i++)
            draws->numbers[i].node = value; /* the value outlives the list */
    }
    return SONJECT_OK;
}

/* Finds the draws of a section of the file: an item's, or the campaign's. */
static sonject_status find_in_section(struct fit_draws *draws, struct report *report,
                                      const struct tree_node *section, const char *path,
                                      const struct draws *list, const struct item *item)
{
    const uint32_t observed = ~draws->unseen;
    for (size_t i = 0; i < section->count; i++) {
        const struct tree_entry *entry = &section->entries[i];
        const bool is_floor = !item && strcmp(entry->key, FLOOR_KEY) == 0;
        const bool is_of_objects =
            !item && strncmp(entry->key, OF_OBJECTS, strlen(OF_OBJECTS)) == 0;
        const char *key = entry->key + (is_of_objects ? strlen(OF_OBJECTS) : 0);
        const struct distribution *distribution = NULL;
        struct fitted_number like = {.unit_scale = 1.0};
        const struct draws *own = item || is_of_objects ? list : &draws->campaign->draws;
        for (size_t k = 0; k < own->count; k++)
            if (own->list[k].key && strcmp(own->list[k].key, key) == 0)
                distribution = &own->list[k];
        snprintf(like.key, sizeof like.key, "%s.%s", path, entry->key);
        if (item && strcmp(key, "level.target_strength") == 0)
            return tree_failure(&draws->campaign->tree, entry->place, like.key,
                                "fit moves levels over the seabed; draw " LEVEL_KEY " instead");
        like.kinds = is_floor                ? FITTED_BIT(FITTED_FLOOR)
                     : item || is_of_objects ? kinds_of_key(key, list, item)
                                             : 0;
        like.kinds &= observed;
        if (distribution && distribution->of && like.kinds)
            like.of_kinds = kinds_of_key(distribution->of, list, item) & observed;
        if (!distribution || !like.kinds || (distribution->of && !like.of_kinds)) {
            growing_text_add(&draws->unchanged, "%s\n", like.key);
            continue;
        }
        CHECK(add_distribution(draws, report, &entry->value, distribution, &like));
        /* lengths may come in any unit */
        char problem[200], one[40];
        for (size_t k = draws->count; k-- > 0 && strcmp(draws->numbers[k].key, like.key) == 0;) {
            snprintf(one, sizeof one, "1%s", draws->numbers[k].unit);
            if ((like.kinds & ALL_SIZES) && !like.of_kinds)
                quantity_from_text(QUANTITY_LENGTH, one, &draws->numbers[k].unit_scale, problem,
                                   sizeof problem);
        }
    }
    return SONJECT_OK;
}

/* Notes sizes of a target that no number moves. The target's numbers are the first of_all ones,
 * those of all objects, and those from the first-th on. */
static void note_fixed(struct fit_draws *draws, const struct item *item, size_t of_all,
                       size_t first)
{
    static const char *const names[] = {"length", "width", "height"};
    const char *before = " (";
    uint32_t moved = 0;
    for (size_t i = 0; i < draws->count; i++)
        moved |= i < of_all || i >= first ? draws->numbers[i].kinds : 0;
    const uint32_t fixed = ALL_SIZES & ~draws->unseen & ~moved;
    if (!fixed)
        return;
    growing_text_add(&draws->fixed, "%s%s",
                     draws->fixed.characters
                         ? ", "
                         : "sizes that are fixed or come from a table are not fitted: ",
                     item->class_name);
    for (uint32_t k = 0; k < COUNT(names); k++)
        if (fixed & FITTED_BIT(k)) {
            growing_text_add(&draws->fixed, "%s%s", before, names[k]);
            before = ", ";
        }
    growing_text_add(&draws->fixed, ")");
}

static const struct tree_node *section_of(const struct tree_node *node, const char *key)
{
    const struct tree_node *value = tree_value(node, key);
    return value && value->kind == TREE_SECTION ? value : NULL;
}

sonject_status fit_draws_find(struct fit_draws *draws, struct report *report,
                              const struct campaign *campaign)
{
    const struct tree_node *root = &campaign->tree.root;
    const struct tree_node *drawn = section_of(root, "draw");
    const struct tree_entry *targets = tree_find(root, "targets");
    size_t bytes;
    draws->campaign = campaign;
    draws->floor_db = NAN;
    CHECK(file_read_whole(report, campaign->path, TREE_BYTES_MAX, &draws->text, &bytes));
    draws->lacks_floor =
        !(draws->unseen & FITTED_BIT(FITTED_FLOOR)) && !draws_have_key(&campaign->draws, FLOOR_KEY);
    if (drawn)
        CHECK(find_in_section(draws, report, drawn, "draw", &campaign->object_draws, NULL));
    const size_t of_all = draws->count;
    for (uint32_t i = 0; i < campaign->target_count; i++) {
        const struct item *item = &campaign->targets[i];
        const struct tree_node *node = section_of(&targets->value.entries[i].value, "draw");
        const size_t first = draws->count;
        char path[48];
        snprintf(path, sizeof path, "targets[%u].draw", (unsigned)i);
        draws->lacks_level[i] =
            !(draws->unseen & FITTED_BIT(FITTED_LEVEL)) &&
            !draws_have_key(&item->draws, LEVEL_KEY) &&
            (item_fixes(item, LEVEL_KEY) || !draws_have_key(&campaign->object_draws, LEVEL_KEY));
        if (strstr(item->object, "\"target_strength\": "))
            return tree_failure(&campaign->tree, item->place, path,
                                "fit moves levels over the seabed; remove the target_strength");
        if (node)
            CHECK(find_in_section(draws, report, node, path, &item->draws, item));
        note_fixed(draws, item, of_all, first);
    }
    return SONJECT_OK;
}

void fit_draws_clear(struct fit_draws *draws)
{
    free(growing_text_end(&draws->unchanged));
    free(growing_text_end(&draws->fixed));
    free(draws->numbers);
    free(draws->text);
    memset(draws, 0, sizeof *draws);
}

/* ---- Moves. */

/* Returns the mean of the moves of several kinds. */
static struct draw_move mean_move(const struct draw_move *moves, uint32_t kinds)
{
    struct draw_move mean = {0.0, 0.0, 0.0};
    double count = 0.0;
    for (uint32_t k = 0; k < FITTED_KINDS; k++)
        if (kinds & FITTED_BIT(k)) {
            mean.centre += moves[k].centre;
            mean.shift += moves[k].shift;
            mean.stretch += log(moves[k].stretch);
            count += 1.0;
        }
    return (struct draw_move){mean.centre / count, mean.shift / count, exp(mean.stretch / count)};
}

static void move_number(struct fitted_number *number, const struct draw_move *moves,
                        const struct fitted_number *mean_before, double mean_was)
{
    const struct draw_move move = mean_move(moves, number->kinds);
    const bool is_size = (number->kinds & ALL_SIZES) != 0;
    if (number->of_kinds)
        number->value *= exp(move.shift - mean_move(moves, number->of_kinds).shift);
    else if (number->is_deviation)
        number->value *= move.stretch * (is_size ? mean_before->value / mean_was : 1.0);
    else if (!is_size)
        number->value = draw_moved(&move, number->value);
    else if (number->value > 0.0)
        number->value =
            exp(draw_moved(&move, log(number->value * number->unit_scale))) / number->unit_scale;
}

void fit_draws_move(struct fit_draws *draws, const struct draw_move *moves)
{
    double was = 1.0;
    for (size_t i = 0; i < draws->count; i++) {
        const double before = draws->numbers[i].value;
        move_number(&draws->numbers[i], moves, i > 0 ? &draws->numbers[i - 1] : NULL, was);
        was = before;
    }
    if (!draws->has_added)
        return;
    for (int i = 0; i < 2; i++)
        draws->level_db[i] = draw_moved(&moves[FITTED_LEVEL], draws->level_db[i]);
    draws->floor_db += moves[FITTED_FLOOR].shift;
}

/* ---- The file's text. */

struct splice {
    size_t offset, length;
    char text[160];
};

/* The changes to the text of a campaign's file. */
struct splice_list {
    struct report *report;
    const struct fit_draws *draws;
    struct splice *splices; /* owned */
    size_t count;
};

/* Returns a place's offset, bytes. Columns count characters, which may have several UTF-8 bytes. */
static size_t offset_of(const char *text, struct tree_place place)
{
    size_t at = 0;
    for (size_t line = 1; line < place.line && text[at]; at++)
        line += text[at] == '\n';
    for (size_t column = 1; column < place.column && text[at]; column++) {
        at++;
        while (((unsigned char)text[at] & 0xC0u) == 0x80u)
            at++;
    }
    return at;
}

/* Returns the number of bytes of a scalar as it is written in the text. */
static size_t scalar_length(const char *at, const struct tree_node *node)
{
    if (!node->is_quoted)
        return strlen(node->text);
    size_t length = 1;
    while (at[length] && at[length] != *at)
        length += at[length] == '\\' && at[length + 1] ? 2 : 1;
    return length + 1;
}

static sonject_status add_splice(struct splice_list *list, size_t offset, size_t length,
                                 const char *text)
{
    CHECK(grow_list(list->report, &list->splices, list->count, sizeof *list->splices,
                    "the campaign"));
    struct splice *splice = &list->splices[list->count++];
    splice->offset = offset;
    splice->length = length;
    snprintf(splice->text, sizeof splice->text, "%s", text);
    return SONJECT_OK;
}

static sonject_status replace_scalar(struct splice_list *list, const struct tree_node *node,
                                     const char *value)
{
    if (node->place.override)
        return report_failure(
            list->report, SONJECT_ERROR_INPUT,
            "--set %s gives a key that the fit changes: write it into the campaign's file",
            node->place.override);
    const size_t offset = offset_of(list->draws->text, node->place);
    return add_splice(list, offset, scalar_length(list->draws->text + offset, node), value);
}

/* Adds "key: value" before a section's first key, in the same style: on a line of its own, or
 * between braces. In the file's own section, the pair goes to the end. */
static sonject_status insert_key(struct splice_list *list, const struct tree_node *section,
                                 const char *pair)
{
    const char *text = list->draws->text;
    const struct tree_node *root = &list->draws->campaign->tree.root;
    const struct tree_entry *first = &section->entries[0];
    if (section->place.override || first->place.override)
        return report_failure(
            list->report, SONJECT_ERROR_INPUT,
            "--set %s gives a key that the fit changes: write it into the campaign's file",
            first->place.override ? first->place.override : section->place.override);
    const size_t offset = offset_of(text, first->place);
    char line[160];
    const bool is_flow = text[offset_of(text, section->place)] == '{';
    if (!is_flow && section == root) {
        const size_t end = strlen(text);
        snprintf(line, sizeof line, "%s%s\n", end > 0 && text[end - 1] != '\n' ? "\n" : "", pair);
        return add_splice(list, end, 0, line);
    }
    snprintf(line, sizeof line, is_flow ? "%s, " : "%s\n%*s", pair,
             is_flow ? 0 : (int)first->place.column - 1, "");
    return add_splice(list, offset, 0, line);
}

/* Sets a key in a section of the campaign, or adds a line with the section at the file's end. */
static sonject_status set_key(struct splice_list *list, const char *name, const char *key,
                              const char *value)
{
    const struct tree_node *section = section_of(&list->draws->campaign->tree.root, name);
    const struct tree_entry *entry = section ? tree_find(section, key) : NULL;
    char pair[160];
    if (entry && entry->value.kind == TREE_TEXT)
        return replace_scalar(list, &entry->value, value);
    snprintf(pair, sizeof pair, "%s: %s", key, value);
    if (section && section->count > 0)
        return insert_key(list, section, pair);
    snprintf(pair, sizeof pair, "%s: {%s: %s}", name, key, value);
    return insert_key(list, &list->draws->campaign->tree.root, pair);
}

/* Writes a value with three significant digits and a unit. */
static const char *write_value(char text[48], double value, const char *unit)
{
    char digits[32];
    snprintf(text, 48, "%s%s", text_of_number(digits, sizeof digits, value, 3), unit);
    return text;
}

static sonject_status splice_levels(struct splice_list *list)
{
    const struct fit_draws *draws = list->draws;
    const struct tree_node *root = &draws->campaign->tree.root;
    const struct tree_entry *targets = tree_find(root, "targets");
    char ends[2][48], pair[160];
    snprintf(pair, sizeof pair, LEVEL_KEY ": {uniform: [%s, %s]}",
             write_value(ends[0], draws->level_db[0], " dB"),
             write_value(ends[1], draws->level_db[1], " dB"));
    for (uint32_t i = 0; i < draws->campaign->target_count; i++) {
        const struct tree_node *item = &targets->value.entries[i].value;
        const struct tree_node *section = section_of(item, "draw");
        char whole[170];
        if (!draws->lacks_level[i])
            continue;
        if (section && section->count > 0) {
            CHECK(insert_key(list, section, pair));
            continue;
        }
        snprintf(whole, sizeof whole, "draw: {%s}", pair);
        CHECK(insert_key(list, item, whole));
    }
    return SONJECT_OK;
}

/* Sets the limits of a section, in place of any that the section has. */
static sonject_status splice_ratio(struct splice_list *list, const struct tree_node *section,
                                   const struct ratio_limits *ratio)
{
    const struct tree_entry *there = tree_find(section, RATIO_KEY);
    char ends[2][48], pair[160];
    if (!(ratio->least > 0.0))
        return SONJECT_OK;
    write_value(ends[0], ratio->least, "");
    write_value(ends[1], ratio->most, "");
    snprintf(pair, sizeof pair, RATIO_KEY ": [%s, %s]", ends[0], ends[1]);
    if (!there)
        return insert_key(list, section, pair);
    for (size_t i = 0; i < 2; i++)
        CHECK(replace_scalar(list, &there->value.entries[i].value, ends[i]));
    return SONJECT_OK;
}

static sonject_status splice_selection(struct splice_list *list,
                                       const struct fitted_selection *selection)
{
    const struct tree_node *root = &list->draws->campaign->tree.root;
    const struct tree_node *visible = section_of(root, "visible");
    const struct tree_entry *swaths = tree_find(root, "swaths");
    char values[2][48], pair[160];
    write_value(values[0], selection->highlight_db, " dB");
    write_value(values[1], selection->shadow_db, " dB");
    if (isfinite(selection->highlight_db) && isfinite(selection->shadow_db) && !visible) {
        snprintf(pair, sizeof pair, "visible: {highlight: %s, shadow: %s, otherwise: redraw}",
                 values[0], values[1]);
        CHECK(insert_key(list, root, pair));
    } else {
        if (isfinite(selection->highlight_db))
            CHECK(set_key(list, "visible", "highlight", values[0]));
        if (isfinite(selection->shadow_db))
            CHECK(set_key(list, "visible", "shadow", values[1]));
    }
    CHECK(splice_ratio(list, section_of(root, "chip"), &selection->chip));
    for (size_t i = 0; selection->swaths && i < swaths->value.count; i++)
        CHECK(splice_ratio(list, &swaths->value.entries[i].value, &selection->swaths[i]));
    return SONJECT_OK;
}

static int compare_splices(const void *a, const void *b)
{
    const struct splice *x = a;
    const struct splice *y = b;
    return x->offset != y->offset ? (x->offset > y->offset) - (x->offset < y->offset)
                                  : strcmp(x->text, y->text);
}

static sonject_status make_splices(struct splice_list *list,
                                   const struct fitted_selection *selection)
{
    const struct fit_draws *draws = list->draws;
    char value[48];
    for (size_t i = 0; i < draws->count; i++) {
        const struct fitted_number *number = &draws->numbers[i];
        CHECK(replace_scalar(list, number->node, write_value(value, number->value, number->unit)));
    }
    if (draws->has_added) {
        CHECK(splice_levels(list));
        if (draws->lacks_floor)
            CHECK(set_key(list, "draw", FLOOR_KEY, write_value(value, draws->floor_db, " dB")));
    }
    CHECK(splice_selection(list, selection));
    qsort(list->splices, list->count, sizeof *list->splices, compare_splices);
    return SONJECT_OK;
}

sonject_status fit_draws_text(const struct fit_draws *draws, struct report *report,
                              const struct fitted_selection *selection, const char *comment,
                              char **text)
{
    struct splice_list list = {report, draws, NULL, 0};
    struct growing_text made = {NULL, 0, 0, false};
    size_t at = strncmp(draws->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* no byte order mark */
    const sonject_status status = make_splices(&list, selection);
    growing_text_add(&made, "%s", comment);
    for (size_t i = 0; status == SONJECT_OK && i < list.count; i++) {
        growing_text_add(&made, "%.*s%s", (int)(list.splices[i].offset - at), draws->text + at,
                         list.splices[i].text);
        at = list.splices[i].offset + list.splices[i].length;
    }
    growing_text_add(&made, "%s", draws->text + at);
    free(list.splices);
    *text = growing_text_end(&made);
    if (status != SONJECT_OK) {
        free(*text);
        *text = NULL;
        return status;
    }
    CHECK_MEMORY(report, *text, "the fitted campaign");
    return SONJECT_OK;
}
