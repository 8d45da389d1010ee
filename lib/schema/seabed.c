/* The keys of the seabed: its backscatter, its surface for sound that goes on, and its relief. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "scene/sediment.h"
#include "schema/keys.h"
#include "swath/swath_file.h"

/* ---- Features of the relief. */

#define STRUCTURE struct relief_feature
static const struct field place_fields[] = {
    PLACE_FIELDS("slant range of the mean seabed there, as the image shows it", -INDEX_MAX)};
static const struct section place_section = {ROWS(place_fields),
                                             .choice = "along_track+slant_range row+column"};

#define POSITION_FIELD                                                                             \
    {                                                                                              \
        "position", "middle's place: centre, {along_track: , slant_range: } or {row: , column: }", \
            CENTRE_WORD, .section = &place_section                                                 \
    }
#define HEIGHT QUANTITY(height_m, LENGTH), WITHIN(0.0, RELIEF_HEIGHT_MAX_M), REQUIRED
#define RADIUS QUANTITY(radius_m, LENGTH), POSITIVE, REQUIRED

static const struct field ripples_fields[] = {
    {"wavelength", "crest-to-crest wavelength", QUANTITY(wavelength_m, LENGTH), POSITIVE, REQUIRED},
    {"height", "height of the ripples, from trough to crest", HEIGHT},
    {"heading", "direction across the ripples' crests, from along-track towards range",
     QUANTITY(heading_rad, ANGLE)},
    {"phase", "phase of the ripples at along-track 0 and ground range 0; a crest is at phase 0",
     QUANTITY(phase_rad, ANGLE)},
    {"sharpness", "sharpness of the crests: 0 is a sine, 1 has narrow crests and wide troughs",
     QUANTITY(sharpness, NUMBER), WITHIN(0.0, 1.0)},
    {"irregularity", "irregularity of the crests: 0 is straight, at 1 they wander, fork and end",
     QUANTITY(irregularity, NUMBER), WITHIN(0.0, 1.0)},
    {"seed", "seed of the ripples' irregularity, which begins at the patch's corner",
     COUNT64(seed, 0, 0)},
};
static const struct section ripples_section = {ROWS(ripples_fields)};

static const struct field mound_fields[] = {
    POSITION_FIELD,
    {"radius", "radius at which the mound, a raised cosine, ends", RADIUS},
    {"height", "height of the mound's top over the ground around it", HEIGHT},
};
static const struct section mound_section = {ROWS(mound_fields)};

static const struct field pit_fields[] = {
    POSITION_FIELD,
    {"radius", "radius at which the pit, a raised cosine, ends", RADIUS},
    {"depth", "depth of the pit's bottom under the ground around it", HEIGHT},
};
static const struct section pit_section = {ROWS(pit_fields)};

static const struct field scour_fields[] = {
    {"object", "name of the object that the scour surrounds; by default all", LABEL(object)},
    {"width", "width of the scour, from the object's outline to its end", QUANTITY(width_m, LENGTH),
     POSITIVE, REQUIRED},
    {"depth", "depth of the scour at and under the object, which rests on the bottom", HEIGHT},
};
static const struct section scour_section = {ROWS(scour_fields)};
#undef STRUCTURE

/* ---- Heights from an image file: the places of its pixels and the meaning of its numbers. */

enum positive_way {
    POSITIVE_UP,
    POSITIVE_DOWN
};

/* The values of the heights' keys. A height is offset_m plus or minus unit_m times the pixel. */
struct heights_text {
    char *path;              /* owned */
    char *array;             /* owned; name of the array in a file of several */
    double unit_m, offset_m; /* length of one unit of the file, m; height of a 0, m */
    uint32_t positive;       /* enum positive_way: the direction of larger numbers */
    sonject_relief_params grid;
};

#define STRUCTURE struct heights_text
static const struct field heights_fields[] = {
    {"file", "image or array of one channel: rows along-track, columns in ground range",
     .kind = FIELD_FILE, MEMBER(path), REQUIRED},
    {"array", "name of the array, in an HDF5 or MATLAB file that has several", TEXT(array)},
    {"unit", "unit of the file's numbers", LENGTH_UNIT(unit_m), REQUIRED},
    {"positive", "direction of larger numbers: up (heights) or down (depths)",
     WORD(positive) = {[POSITIVE_UP] = "up", [POSITIVE_DOWN] = "down"}},
    {"offset", "height over the mean seabed that a 0 in the file stands for",
     QUANTITY(offset_m, LENGTH), COORDINATE},
    {"row_spacing", "distance between rows", QUANTITY(grid.row_spacing_m, LENGTH), POSITIVE,
     REQUIRED},
    {"column_spacing", "distance between columns, horizontal",
     QUANTITY(grid.column_spacing_m, LENGTH), POSITIVE, REQUIRED},
    {"first_ground_range", "ground range of column 0, horizontal from the track",
     QUANTITY(grid.first_ground_range_m, LENGTH), COORDINATE, REQUIRED},
    {"first_along_track", "track position of row 0", QUANTITY(grid.first_along_track_m, LENGTH),
     COORDINATE},
};
static const struct section heights_section = {ROWS(heights_fields)};
#undef STRUCTURE

/* The grid of heights, for its defaults and the scene's hash. */
#define STRUCTURE sonject_relief_params
static const struct field relief_grid_fields[] = {
    {"rows", "rows of heights", COUNT32(rows, 0, 0)},
    {"columns", "columns of heights", COUNT32(columns, 0, 0)},
    {"row_spacing", "distance between rows", QUANTITY(row_spacing_m, LENGTH), .preset = 0.025},
    {"column_spacing", "distance between columns", QUANTITY(column_spacing_m, LENGTH),
     .preset = 0.025},
    {"first_ground_range", "ground range of column 0", QUANTITY(first_ground_range_m, LENGTH)},
    {"first_along_track", "track position of row 0", QUANTITY(first_along_track_m, LENGTH)},
};
const struct section relief_grid_section = {ROWS(relief_grid_fields), .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

static float height_of(const struct heights_text *text, double number)
{
    const double unit_m = text->positive == POSITIVE_DOWN ? -text->unit_m : text->unit_m;
    const double height = text->offset_m + unit_m * number;
    return (float)(fabs(height) > (double)FLT_MAX ? copysign(INFINITY, height) : height);
}

/* Takes the heights of an array, or else of an image file's pixels. Sizes that no relief may have
 * are refused before anything is held in memory. A pixel that is not a number is refused with its
 * row and column. */
static sonject_status take_heights(struct scene *scene, struct report *report,
                                   struct heights_text *text, const struct number_array *array,
                                   struct swath_file *file)
{
    struct raster_layout layout = {.channels = 1};
    if (array) {
        layout.rows = array->rows;
        layout.columns = array->column_count;
    } else {
        swath_file_layout(file, &layout);
    }
    if (layout.channels != 1)
        return input_failure(report, text->path, "has %lu channels; heights need one",
                             (unsigned long)layout.channels);
    if (!relief_grid_fits(layout.rows, layout.columns))
        return input_failure(report, text->path,
                             "has %llu rows and %llu columns; heights need 2...%u each, at "
                             "most 2^24 points: cut out or thin out",
                             (unsigned long long)layout.rows, (unsigned long long)layout.columns,
                             RELIEF_GRID_SIDE_MAX);
    const size_t count = (size_t)(layout.rows * layout.columns);
    void *pixels = NULL;
    if (!array)
        CHECK(swath_file_read_all(report, file, &layout, &pixels));
    float *heights = allocate_array(count, sizeof *heights);
    text->grid.rows = (uint32_t)layout.rows;
    text->grid.columns = (uint32_t)layout.columns;
    sonject_status status = heights ? SONJECT_OK : report_out_of_memory(report, text->path);
    for (size_t i = 0; status == SONJECT_OK && i < count; i++) {
        heights[i] =
            height_of(text, array ? array->values[i] : pixel_number(layout.type, pixels, i));
        if (!(fabs((double)heights[i]) <= RELIEF_HEIGHT_MAX_M))
            status = report_failure(report, SONJECT_ERROR_INPUT,
                                    "%s: relief must be within %g m of the mean seabed; at row "
                                    "%zu, column %zu it is %g m",
                                    text->path, RELIEF_HEIGHT_MAX_M, i / text->grid.columns,
                                    i % text->grid.columns, (double)heights[i]);
    }
    if (status == SONJECT_OK)
        relief_features_take_grid(&scene->relief, &text->grid, heights);
    else
        free(heights);
    free(pixels);
    return status;
}

static sonject_status load_heights(struct reader *reader, struct report *report,
                                   struct heights_text *text)
{
    struct swath_file *file;
    const struct number_array *array = find_array(reader, text->path);
    if (array)
        return take_heights(reader->scene, report, text, array, NULL);
    CHECK(file_note_read(reader->report, text->path));
    CHECK(swath_file_open_array(report, text->path, SONJECT_CHANNEL_ONLY, text->array, &file));
    const sonject_status status = take_heights(reader->scene, report, text, NULL, file);
    swath_file_close(&file);
    return status;
}

/* Reads heights into the scene. Messages about the file get its place in the scene file. */
static sonject_status read_relief_heights(struct reader *reader, const struct tree_node *node,
                                          void *structure)
{
    struct heights_text text = {.path = NULL};
    struct report report = {.host = reader->report->host};
    (void)structure;
    if (reader->scene->relief.heights_m)
        return refuse_value(reader, node, "only one file of heights is possible; join them");
    sonject_status status = read_section(reader, &heights_section, node, &text);
    if (status == SONJECT_OK) {
        status = load_heights(reader, &report, &text);
        if (status != SONJECT_OK)
            refuse_key(reader, node, "file", "%s", report.message);
    }
    free(text.path);
    free(text.array);
    return status;
}

/* ---- The relief: a list of features. */

#define STRUCTURE struct relief_feature
static const struct field relief_fields[] = {
    {"kind", "kind of feature", HIDDEN, WORD(kind) = {"ripples", "mound", "pit", "scour"}},
    {"ripples", "sand ripples", SAME(ripples_section), SETS(kind, RELIEF_RIPPLES)},
    {"mound", "a round rise", SAME(mound_section), SETS(kind, RELIEF_MOUND)},
    {"pit", "a round hollow", SAME(pit_section), SETS(kind, RELIEF_PIT)},
    {"scour", "hollows around objects", SAME(scour_section), SETS(kind, RELIEF_SCOUR)},
    {"heights", "heights from a file", .kind = FIELD_SPECIAL, .section = &heights_section,
     .read = read_relief_heights},
};
const struct section relief_section = {ROWS(relief_fields),
                                       .choice = "ripples mound pit scour heights"};
#undef STRUCTURE

static sonject_status read_feature(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct relief_feature feature;
    (void)structure;
    memset(&feature, 0, sizeof feature);
    CHECK(read_section(reader, &relief_section, node, &feature));
    return is_given(node, "heights") /* heights are in the scene already */
               ? SONJECT_OK
               : relief_features_append(&reader->scene->relief, reader->report, &feature);
}

static sonject_status read_relief(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    static const struct list relief = {0, RELIEF_FEATURES_MAX, "; start each feature with '- '",
                                       read_feature};
    return tree_is_null(node) ? SONJECT_OK : read_list(reader, node, &relief, structure);
}

/* ---- The seabed. */

static void relate_seabed(struct check *check, const void *structure)
{
    const sonject_seabed_params *seabed = structure;
    relate_energy(check, "forward.", &seabed->forward, seabed->lambert);
}

/* ---- Sediments with a backscatter model (scene/sediment.h). */

static sonject_status read_sediment(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    uint32_t index;
    CHECK(find_material(reader, node, true, &index));
    ((sonject_seabed_params *)structure)->grain_size_phi = material_grain_size(index);
    return SONJECT_OK;
}

#define STRUCTURE sonject_seabed_params
static const struct field sediment_fields[] = {
    {"grain_size", "mean grain size in phi: -log2 of the diameter in mm",
     QUANTITY(grain_size_phi, NUMBER), WITHIN(GRAIN_SIZE_LEAST_PHI, GRAIN_SIZE_MOST_PHI),
     NONE_IF_NAN, REQUIRED},
};
static const struct section sediment_section = {ROWS(sediment_fields)};
#undef STRUCTURE

static sonject_status finish_seabed(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    (void)structure;
    if (is_given(node, "lambert") && is_given(node, "sediment"))
        refuse_relation(reader, node, "lambert", "sediment",
                        "the sediment sets it, too; remove one of the two");
    return SONJECT_OK;
}

/* The preset is Mackenzie's, 10^-2.7. The slack lets 1/pi in decimal digits pass. */
#define STRUCTURE sonject_seabed_params
static const struct field seabed_fields[] = {
    {"lambert", "backscatter coefficient mu at normal incidence; -27 dB on Mackenzie's seabed",
     QUANTITY(lambert, LEVEL), WITHIN(0.0, (1.0 + 1e-12) / PI), .bounds = ABOVE_LEAST,
     .preset = 1.995262314968879e-3,
     .range = "above 0 and at most 1/pi (-4.97 dB), or the seabed returns more than it receives"},
    {"sediment",
     "sediment that sets lambert, by APL-UW TR 9407 (10 to 100 kHz) at the middle of the patch's "
     "seabed: gravel, coarse sand, medium sand, fine sand, silt, clay or {grain_size: }",
     .kind = FIELD_NAMED, .section = &sediment_section, .read = read_sediment},
    {"map", "reflectivity that resynthesise takes from the image; composites weight shadows by it",
     WORD(map) = {[SONJECT_MAP_INTENSITY] = "intensity",
                  [SONJECT_MAP_DESPECKLED] = "despeckled",
                  [SONJECT_MAP_COHERENT] = "coherent"},
     .preset = SONJECT_MAP_INTENSITY},
    {"level_radius", "radius of the local mean that lambert stands for",
     QUANTITY(level_radius_m, LENGTH), POSITIVE, .preset = 3.0},
    {"despeckle_radius", "radius of the despeckled map's local mean",
     QUANTITY(despeckle_radius_m, LENGTH), POSITIVE, .preset = 0.1},
    {"forward",
     "seabed surface for sound that does not go straight back: a sediment's name, or a section",
     .kind = FIELD_NAMED, MEMBER(forward), .section = &forward_section, .read = read_sediment_name},
    {"relief",
     "list of ripples, mounds, pits, scour and heights, which add up; by default the seabed is "
     "flat",
     .kind = FIELD_SPECIAL, .section = &relief_section, .is_list = true, .read = read_relief},
};
const struct section seabed_section = {ROWS(seabed_fields), .relations = relate_seabed,
                                       .finish = finish_seabed, .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE
