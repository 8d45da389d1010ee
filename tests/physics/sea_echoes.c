/* The sea's lines and energies (sea.h) before the image is formed. */
#include "sea.h"

/* Adds strips of bins to the line's bins. */
static void add_strips(struct line *line, int32_t first_line_bin, const struct line_grid *grid,
                       struct span strips, const float *real_part, const float *imaginary_part)
{
    const size_t bins = (size_t)grid->bins.count;
    double complex *values = line->values + (grid->bins.first - first_line_bin);
    for (size_t i = 0; i < (size_t)strips.count * bins; i++)
        values[i % bins] += real_part[i] + I * (double)imaginary_part[i];
}

static void add_glints(struct sea *sea, struct glints *glints, struct line *line, int32_t first_bin)
{
    const struct line_grid *grid = &glints->grid;
    const size_t cells = (size_t)glints->chunk * (size_t)grid->bins.count;
    float *parts = zeroed(2 * cells, sizeof *parts);
    for (int32_t done = 0; done < grid->strips.count; done += glints->chunk) {
        const int32_t left = grid->strips.count - done;
        const struct span strips = {grid->strips.first + done,
                                    left < glints->chunk ? left : glints->chunk};
        EXPECT_OK(&sea->bench->report,
                  glints_trace(glints, &sea->bench->tracer, strips, parts, parts + cells));
        add_strips(line, first_bin, grid, strips, parts, parts + cells);
    }
    free(parts);
}

static void add_multibounce(const struct multibounce *multibounce, struct line *line,
                            int32_t first_bin)
{
    for (size_t i = 0; i < multibounce->region_count; i++) {
        const struct multibounce_region *region = &multibounce->regions[i];
        const struct line_grid grid = {.strips = region->strips, .bins = region->bins};
        const size_t cells = line_grid_cells(&grid);
        float *parts = zeroed(2 * cells, sizeof *parts);
        multibounce_read(multibounce, region->strips, region->bins, parts, parts + cells);
        add_strips(line, first_bin, &grid, region->strips, parts, parts + cells);
        free(parts);
    }
}

/* The object must be one part. */
struct line sea_line(struct sea *sea, uint32_t object)
{
    struct tracer *tracer = &sea->bench->tracer;
    struct glints glints;
    struct multibounce multibounce;
    struct line line;
    sea_lay(sea);
    EXPECT_OK(&sea->bench->report, glints_begin(&glints, tracer, object));
    EXPECT_OK(&sea->bench->report, multibounce_begin(&multibounce, tracer, object));
    struct span bins = glints.grid.bins;
    for (size_t i = 0; i < multibounce.region_count; i++)
        bins = span_join(bins, multibounce.regions[i].bins);
    line.bins = (size_t)bins.count;
    line.spacing_m = tracer->view.column_spacing_m / glints.grid.bins_per_pixel;
    line.first_range_m = tracer->view.first_range_m + bins.first * line.spacing_m;
    line.values = claim_memory(line.bins, sizeof *line.values);
    add_glints(sea, &glints, &line, bins.first);
    add_multibounce(&multibounce, &line, bins.first);
    multibounce_end(&multibounce);
    glints_end(&glints);
    return line;
}

double complex line_at(const struct sea *sea, const struct line *line, double range_m)
{
    double complex sum = 0.0;
    for (size_t i = 0; i < line->bins; i++)
        sum += line->values[i] *
               sea_pulse(sea, range_m - (line->first_range_m + (double)i * line->spacing_m));
    return sum;
}

double line_peak(const struct sea *sea, const struct line *line, double *range_m)
{
    double largest = 0.0;
    for (size_t i = 0; i < line->bins; i++) {
        const double range = line->first_range_m + (double)i * line->spacing_m;
        const double amplitude = cabs(line_at(sea, line, range));
        if (amplitude > largest && range_m)
            *range_m = range;
        largest = fmax(largest, amplitude);
    }
    return largest;
}

double line_energy(const struct line *line)
{
    double energy = 0.0;
    for (size_t i = 0; i < line->bins; i++)
        energy += pow(cabs(line->values[i]), 2.0);
    return energy;
}

double line_energy_in_band(const struct sea *sea, const struct line *line)
{
    double energy = 0.0;
    for (size_t bin = 0; bin < line->bins; bin += 4)
        energy +=
            pow(cabs(line_at(sea, line, line->first_range_m + line->spacing_m * (double)bin)), 2.0);
    return energy;
}

void line_add(struct line *sum, const struct line *line, double factor)
{
    const long shift = lround((sum->first_range_m - line->first_range_m) / line->spacing_m);
    for (size_t bin = 0; bin < sum->bins; bin++) {
        const long other = (long)bin + shift;
        if (other >= 0 && other < (long)line->bins)
            sum->values[bin] += factor * line->values[other];
    }
}

double sea_peak(struct sea *sea, double *range_m)
{
    const struct line line = sea_line(sea, 0);
    return line_peak(sea, &line, range_m);
}

/* ---- energies before the image is formed ---- */

static struct strips strips_of(const struct line_grid *grid, const float *energy)
{
    return (struct strips){grid->strips.count,
                           grid->bins.count,
                           grid->strips.first,
                           grid->bins.first,
                           (int)grid->strips_per_row,
                           (int)grid->bins_per_pixel,
                           energy};
}

struct strips sea_rough(struct sea *sea, struct tile_sums *sums, struct strips *tiles)
{
    return sea_rough_of(sea, false, sums, tiles);
}

struct strips sea_rough_of(struct sea *sea, bool is_beam, struct tile_sums *sums,
                           struct strips *tiles)
{
    static struct rough_trace trace;
    struct tracer *tracer = &sea->bench->tracer;
    sea_lay(sea);
    EXPECT_OK(&sea->bench->report, is_beam
                                       ? rough_trace_begin_beam(&trace, tracer, &tracer->response)
                                       : rough_trace_begin(&trace, tracer, NULL));
    float *energy = claim_memory(line_grid_cells(&trace.grid), sizeof *energy);
    float *planes = claim_memory(trace.tile_elements + 1, sizeof *planes);
    const int32_t end = trace.grid.strips.first + trace.grid.strips.count;
    struct span some = {trace.grid.strips.first, trace.chunk};
    for (float *lines = energy; some.first < end; some.first += some.count) {
        some.count = end - some.first < trace.chunk ? end - some.first : trace.chunk;
        EXPECT_OK(&sea->bench->report, rough_trace_strips(&trace, tracer, some, lines));
        lines += (size_t)some.count * (size_t)trace.grid.bins.count;
    }
    if (tracer->part_count > 0)
        EXPECT_OK(&sea->bench->report, rough_trace_tiles(&trace, tracer, planes));
    for (uint32_t part = 0; part < tracer->part_count; part++) {
        const float *first = planes + trace.tiles[part].offset;
        const size_t plane = line_grid_cells(&trace.tiles[part].grid);
        if (sums) {
            sums[part].energy = sum_of(first + TILE_ENERGY * plane, plane);
            sums[part].lost = sum_of(first + TILE_LOST * plane, plane);
            sums[part].footprint = sum_of(first + TILE_FOOTPRINT * plane, plane);
        }
        if (tiles)
            tiles[part] = strips_of(&trace.tiles[part].grid, first + TILE_ENERGY * plane);
    }
    const struct strips strips = strips_of(&trace.grid, energy);
    rough_trace_end(&trace);
    return strips;
}

struct strips sea_grid(const struct sea *sea, double *first_x, double *last_x)
{
    struct line_grid grid;
    line_grid_for_patch(&grid, sea_view(sea), sea_response(sea));
    const double strips = grid.strips_per_row;
    *first_x = sea_x(sea, grid.strips.first / strips - 0.5);
    *last_x = sea_x(sea, (grid.strips.first + grid.strips.count) / strips - 0.5);
    return strips_of(&grid, NULL);
}

static void add_chains(struct sea *sea, const struct ranges *ranges,
                       void (*change)(struct bench *, struct chain_trace *),
                       struct energies *energies)
{
    struct tracer *tracer = &sea->bench->tracer;
    struct chain_trace trace;
    EXPECT_OK(&sea->bench->report, chain_trace_begin(&trace, tracer, NULL));
    if (change)
        change(sea->bench, &trace);
    for (uint32_t i = 0; i < chain_fan_count(tracer); i++) {
        struct chain_fan fan;
        EXPECT_OK(&sea->bench->report, chain_fan_init(&fan, tracer, &trace.grid, false, i));
        EXPECT_OK(&sea->bench->report, chain_trace_strips(&trace, tracer, &fan, fan.strips));
    }
    const size_t cells = line_grid_cells(&trace.grid);
    float *plane = zeroed(cells, sizeof *plane);
    for (uint32_t p = 0; p < trace.orders; p++) {
        const uint32_t order = trace.first_order - 1 + p;
        double values[CHAIN_RANGES] = {0.0};
        EXPECT_OK(&sea->bench->report, chain_trace_read(&trace, tracer, p, plane));
        for (size_t i = 0; i < cells; i++) {
            const int32_t bin =
                trace.grid.bins.first + (int32_t)(i % (size_t)trace.grid.bins.count);
            const double range = sea_range(sea, (double)bin / trace.grid.bins_per_pixel);
            const int at =
                ranges->count > 0 ? (int)floor((range - ranges->first_m) / ranges->width_m) : 0;
            if (at >= 0 && at < (ranges->count > 0 ? ranges->count : 1))
                values[at] += (double)plane[i];
        }
        for (int range = 0; order < CHAIN_ORDERS && range < CHAIN_RANGES; range++) {
            energies->sum[order][range] += values[range];
            energies->square[order][range] += values[range] * values[range];
        }
    }
    free(plane);
    chain_trace_end(&trace);
}

struct energies sea_changed_chains(struct sea *sea, const struct ranges *ranges,
                                   uint64_t first_seed, int seeds,
                                   void (*change)(struct bench *bench, struct chain_trace *trace))
{
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    sea_lay(sea);
    for (; energies.seeds < seeds; energies.seeds++) {
        sea->injection->seed = first_seed + (uint64_t)energies.seeds;
        add_chains(sea, ranges, change, &energies);
    }
    return energies;
}

struct energies sea_chains(struct sea *sea, const struct ranges *ranges, uint64_t first_seed,
                           int seeds)
{
    return sea_changed_chains(sea, ranges, first_seed, seeds, NULL);
}

struct estimate energy_of(const struct energies *energies, int order, int range)
{
    return estimate_of_sums(energies->sum[order][range], energies->square[order][range],
                            energies->seeds);
}

void expect_energies(const char *what, const struct energies *measured, int order,
                     const struct estimate *expected, int count, double systematic, double resolved,
                     int least)
{
    int compared = 0;
    double most = 0.0, expected_sum = 0.0;
    struct estimate sum = {0.0, 0.0};
    for (int range = 0; range < count; range++)
        most = fmax(most, expected[range].mean);
    for (int range = 0; range < count; range++) {
        struct estimate energy = energy_of(measured, order, range);
        energy.error = hypot(energy.error, expected[range].error);
        if (expected[range].mean < 0.02 * most) /* at the edge of the earliest echoes */
            continue;
        print_message("%s, order %d, range %d: ", what, order + 1, range);
        expect_estimate("energy, m2", energy, expected[range].mean,
                        systematic * expected[range].mean);
        compared += energy.error < resolved * expected[range].mean;
        sum = (struct estimate){sum.mean + energy.mean, hypot(sum.error, energy.error)};
        expected_sum += expected[range].mean;
    }
    print_message("%s, order %d, these ranges: ", what, order + 1);
    expect_estimate("energy, m2", sum, expected_sum, systematic * expected_sum);
    assert_true(most > 0.0 && compared >= least);
}
