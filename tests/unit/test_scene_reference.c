/* Tests that tools/scenes/KEYS.md and tools/campaigns/KEYS.md, the references of scene and campaign
 * files, are those of the tables of keys. With two files' names the program writes them. */
#include <jansson.h>

#include "claims.h"
#include "dataset/campaign.h"
#include "scene/shapes/shape.h"
#include "schema/scene_file.h"
#include "temporary_folder.h"

#define PART_PREFIX "objects[].parts[]."
#define ROUNDING    1e-14 /* of the 15 digits that the list's numbers have */

static const char introduction[] =
    "# Keys of scene files\n\n"
    "A scene is a YAML file; `tools/scenes/demo.yaml` is one that explains itself. Numbers take "
    "the "
    "units below, or none: then\n"
    "metres, hertz, degrees, seconds and so on are meant. `[]` stands for each entry of a list, "
    "counted from 0 in `--set 'objects[0].heading=90 deg'`. Keys\n"
    "marked * must be there if their section is. A default of – is none: the key then does "
    "nothing, "
    "or its meaning says what\n"
    "is done. Sections may refuse combinations besides, with a message.\n";

static const char *text_of(const json_t *key, const char *what)
{
    const char *text = json_string_value(json_object_get(key, what));
    return text ? text : "";
}

/* True for a part's key whose meaning is that of the object's key. */
static bool is_repeated(const json_t *keys, const json_t *key)
{
    const char *path = text_of(key, "path");
    size_t i;
    json_t *other;
    json_array_foreach(keys, i, other)
    {
        const char *alike = text_of(other, "path");
        if (strncmp(path, PART_PREFIX, strlen(PART_PREFIX)) == 0 &&
            strncmp(alike, "objects[].", 10) == 0 &&
            strcmp(alike + 10, path + strlen(PART_PREFIX)) == 0)
            return strcmp(text_of(other, "meaning"), text_of(key, "meaning")) == 0;
    }
    return false;
}

/* Prints a cell, in which a "|" is escaped, as it would end the cell. */
static void print_cell(FILE *out, const char *text)
{
    fputc(' ', out);
    for (; *text; text++)
        fprintf(out, *text == '|' ? "\\%c" : "%c", *text);
    fputs(" |", out);
}

static void print_range(FILE *out, const json_t *key)
{
    char words[400] = "";
    size_t i;
    json_t *word;
    const bool is_word = strcmp(text_of(key, "kind"), "word") == 0;
    json_array_foreach(json_object_get(key, "words"), i, word)
        snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", i ? ", " : "",
                 json_string_value(word));
    print_cell(out, is_word ? words : text_of(key, "range"));
}

static void print_key(FILE *out, const json_t *key)
{
    const char *preset = text_of(key, "default");
    fprintf(out, "| `%s`%s |", text_of(key, "path"),
            json_is_true(json_object_get(key, "is_required")) ? " *" : "");
    print_cell(out, text_of(key, "meaning"));
    print_cell(out, text_of(key, "unit"));
    print_cell(out, *preset ? preset : "–");
    print_range(out, key);
    fputc('\n', out);
}

/* Begins a table for each section, the path's name at the top level. */
static void print_heading(FILE *out, const char *path, const char *before)
{
    const size_t length = strcspn(path, ".[");
    if (strcspn(before, ".[") == length && strncmp(path, before, length) == 0)
        return;
    fprintf(out, "\n## %.*s\n\n| key | meaning | unit | default | range |\n|---|---|---|---|---|\n",
            (int)length, path);
}

static void print_shape_keys(FILE *out)
{
    const char *joint = "";
    fputs("\nA shape's keys, in brackets those that it may have:", out);
    for (uint32_t shape = 0; shape < SHAPE_PARTS; shape++) {
        fprintf(out, "%s `%s`", joint, shape_name(shape));
        joint = ":";
        for (const struct shape_key_name *its = shape_keys; its->key; its++) {
            if (shape_of(shape)->needs & its->bit)
                fprintf(out, "%s %s", joint, its->key);
            else if (shape_of(shape)->may_have & its->bit)
                fprintf(out, "%s (%s)", joint, its->key);
            else
                continue;
            joint = ",";
        }
        joint = ";";
    }
    fputs(".\n", out);
}

/* Prints a material's row. A constant reflection has no fluid. */
static void print_material(FILE *out, const char *name)
{
    sonject_material_params material;
    assert_true(material_named(name, &material));
    const bool is_fluid = material.reflection_kind == SONJECT_REFLECTION_FLUID;
    const double impedance = material.density_ratio * material.speed_ratio;
    fprintf(out, "| %s |", name);
    if (is_fluid)
        fprintf(out, " %g | %g | %g |", material.density_ratio, material.speed_ratio,
                material.loss);
    else
        fputs(" – | – | – |", out);
    fprintf(out, " %.2f | %g | %.1f |\n",
            is_fluid ? (impedance - 1.0) / (impedance + 1.0) : material.reflection,
            1e3 * material.roughness_m, 10.0 * log10(material.lambert));
}

static void print_materials(FILE *out)
{
    fputs("\n## Materials by name\n\nDensity and speed of sound are ratios to the water's. "
          "Reflection is the share of the amplitude that a smooth surface returns square on; "
          "roughness lessens it. Lambert is what the rough part returns square on.\n\n"
          "| name | density | speed | loss | reflection | roughness, mm | lambert, dB |\n"
          "|---|---|---|---|---|---|---|\n",
          out);
    for (uint32_t i = 0; material_name(i); i++)
        print_material(out, material_name(i));
}

static void print_reference(FILE *out, const json_t *keys)
{
    const char *before = "";
    const char *joint = "";
    size_t i;
    json_t *key;
    fputs(introduction, out);
    json_array_foreach(keys, i, key)
    {
        if (!json_is_true(json_object_get(key, "has_value")) || is_repeated(keys, key))
            continue;
        print_heading(out, text_of(key, "path"), before);
        print_key(out, key);
        before = text_of(key, "path");
    }
    fputs("\nParts, `objects[].parts[]`, also have these keys of objects, with the same meaning:",
          out);
    json_array_foreach(keys, i, key) if (json_is_true(json_object_get(key, "has_value")) &&
                                         is_repeated(keys, key))
    {
        fprintf(out, "%s `%s`", joint, text_of(key, "path") + strlen(PART_PREFIX));
        joint = ",";
    }
    fputs(".\n", out);
    print_shape_keys(out);
    print_materials(out);
}

/* Prints one table, since a campaign has few keys and its sections say what they are for. */
static void print_campaign_reference(FILE *out, const json_t *keys)
{
    size_t i;
    json_t *key;
    fputs("# Keys of campaign files\n\n"
          "[Data sets](../../docs/data_sets.md) tells what campaigns are for, and "
          "[minefield.yaml](minefield.yaml) is one that explains itself. `[]` stands for each "
          "entry of a list.\n"
          "Keys marked * must be there if their section is. A default of – is none, or the meaning "
          "says it. `object`, `draw` and `set` take [keys of scenes](../scenes/KEYS.md).\n\n"
          "| key | meaning | unit | default | range |\n|---|---|---|---|---|\n",
          out);
    json_array_foreach(keys, i, key) print_key(out, key);
}

/* The two references. */
static const struct reference {
    const char *file;
    const struct section *section;
    void (*print)(FILE *out, const json_t *keys);
} references[] = {
    {SOURCE_ROOT "/tools/scenes/KEYS.md", &scene_section, print_reference},
    {SOURCE_ROOT "/tools/campaigns/KEYS.md", &campaign_section, print_campaign_reference},
};

/* Returns a whole reference. The caller frees it. */
static char *make_reference(const struct reference *reference)
{
    struct report report = {.host = NULL};
    char *listed;
    size_t bytes;
    FILE *out = tmpfile();
    assert_int_equal(section_keys_json(&report, reference->section, &listed), SONJECT_OK);
    json_t *keys = json_loads(listed, 0, NULL);
    assert_true(out && json_is_array(keys));
    reference->print(out, keys);
    json_decref(keys);
    free(listed);
    return (char *)bytes_of_stream(out, &bytes);
}

static void check_reference(const struct reference *reference)
{
    char *expected = make_reference(reference);
    char *found = calloc(strlen(expected) + 2, 1);
    FILE *stream = fopen(reference->file, "rb");
    assert_true(found && stream);
    found[fread(found, 1, strlen(expected) + 1, stream)] = 0;
    fclose(stream);
    if (strcmp(found, expected) != 0)
        fail_msg("%s is not up to date: run this program with both names", reference->file);
    free(found);
    free(expected);
}

TEST(test_the_references_are_up_to_date)
{
    for (size_t i = 0; i < COUNT(references); i++)
        check_reference(&references[i]);
}

/* Numbers are told in SI units, angles in degrees. */
TEST(test_limits_that_are_told_are_within_the_limits)
{
    struct report report = {.host = NULL};
    size_t angles = 0, i;
    json_t *key;
    char *listed;
    assert_int_equal(section_keys_json(&report, &scene_section, &listed), SONJECT_OK);
    json_t *keys = json_loads(listed, 0, NULL);
    json_array_foreach(keys, i, key)
    {
        const char *range = text_of(key, "range"), *dots = strstr(range, "...");
        const bool is_angle = strstr(text_of(key, "unit"), "deg") != NULL;
        const double scale = is_angle ? PI / 180.0 : 1.0;
        if (!dots || !json_is_number(json_object_get(key, "least")))
            continue;
        const double least = json_number_value(json_object_get(key, "least"));
        const double most = json_number_value(json_object_get(key, "most"));
        char low[40];
        snprintf(low, sizeof low, "%.*s", (int)(dots - range), range);
        assert_true(scale * strtod(dots + 3, NULL) <= most + fabs(most) * ROUNDING);
        assert_true(scale * strtod(low, NULL) >= least - fabs(least) * ROUNDING);
        angles += is_angle;
    }
    assert_true(angles > 5);
    json_decref(keys);
    free(listed);
}

int main(int argc, char **argv)
{
    if (argc != 1 + (int)COUNT(references))
        return run_own_tests(NULL, NULL);
    for (size_t i = 0; i < COUNT(references); i++) {
        FILE *stream = fopen(argv[1 + i], "wb");
        if (!stream)
            return 1;
        char *text = make_reference(&references[i]);
        fputs(text, stream);
        free(text);
        if (fclose(stream) != 0)
            return 1;
    }
    return 0;
}
