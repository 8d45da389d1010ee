#include "mesh/split.h"

#include <float.h>
#include <string.h>

#define BINS_MOST 16

void split_box_unite(struct split_box *box, const struct split_box *other)
{
    for (int i = 0; i < 8; i++)
        box->edges[i] = other->edges[i] < box->edges[i] ? other->edges[i] : box->edges[i];
}

struct split_box split_box_empty(void)
{
    const struct split_box empty = {
        {FLT_MAX, FLT_MAX, FLT_MAX, 0.0f, FLT_MAX, FLT_MAX, FLT_MAX, 0.0f}};
    return empty;
}

static float extent(const struct split_box *box, int axis)
{
    return -box->edges[4 + axis] - box->edges[axis];
}

float split_box_area(const struct split_box *box)
{
    if (box->edges[0] > -box->edges[4])
        return 0.0f;
    const float x = extent(box, 0);
    const float y = extent(box, 1);
    const float z = extent(box, 2);
    return x * y + y * z + z * x;
}

struct split_box split_box_of(const struct split_triangle *triangles, size_t first, size_t last)
{
    struct split_box box = split_box_empty();
    for (size_t i = first; i < last; i++)
        split_box_unite(&box, &triangles[i].box);
    return box;
}

/* Twice the middle of a triangle's box. */
static float middle(const struct split_triangle *triangle, int axis)
{
    return triangle->box.edges[axis] - triangle->box.edges[4 + axis];
}

/* The range's middles, sorted into equal bins along each axis. */
struct bins {
    int count;
    float lower[3], scale[3]; /* scale 0: all middles are the same along the axis */
    struct split_box boxes[3][BINS_MOST];
    uint32_t triangles[3][BINS_MOST];
};

static int bin_of(const struct bins *bins, const struct split_triangle *triangle, int axis)
{
    const int bin = (int)((middle(triangle, axis) - bins->lower[axis]) * bins->scale[axis]);
    return bin < bins->count ? bin : bins->count - 1;
}

/* Few bins for few triangles: most ranges are small. */
static int bins_for(size_t count)
{
    return count >= 64 ? BINS_MOST : count >= 16 ? 8 : 4;
}

static void set_bins(struct bins *bins, const struct split_triangle *triangles,
                     const struct split_range *range)
{
    float lower[3] = {FLT_MAX, FLT_MAX, FLT_MAX};
    float upper[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (size_t i = range->first; i < range->last; i++) {
        for (int axis = 0; axis < 3; axis++) {
            const float value = middle(&triangles[i], axis);
            lower[axis] = value < lower[axis] ? value : lower[axis];
            upper[axis] = value > upper[axis] ? value : upper[axis];
        }
    }
    bins->count = bins_for(range->last - range->first);
    for (int axis = 0; axis < 3; axis++) {
        const float width = upper[axis] - lower[axis];
        bins->lower[axis] = lower[axis];
        bins->scale[axis] = width > FLT_MIN * 64.0f ? 0.9999f * (float)bins->count / width : 0.0f;
        for (int bin = 0; bin < bins->count; bin++) {
            bins->boxes[axis][bin] = split_box_empty();
            bins->triangles[axis][bin] = 0;
        }
    }
}

static void fill_bins(struct bins *bins, const struct split_triangle *triangles,
                      const struct split_range *range)
{
    for (size_t i = range->first; i < range->last; i++) {
        for (int axis = 0; axis < 3; axis++) {
            const int bin = bin_of(bins, &triangles[i], axis);
            split_box_unite(&bins->boxes[axis][bin], &triangles[i].box);
            bins->triangles[axis][bin]++;
        }
    }
}

struct cut {
    int axis, bin; /* the lower half is bins below `bin` */
    float cost;    /* triangles times area, of both halves */
    size_t lower_count;
};

/* The best cut along one axis, if better than *best. */
static void try_axis(const struct bins *bins, int axis, struct cut *best)
{
    float upper_cost[BINS_MOST];
    struct split_box box = split_box_empty();
    size_t count = 0;
    for (int bin = bins->count - 1; bin > 0; bin--) {
        split_box_unite(&box, &bins->boxes[axis][bin]);
        count += bins->triangles[axis][bin];
        upper_cost[bin] = split_box_area(&box) * (float)count;
    }
    const size_t all = count + bins->triangles[axis][0];
    box = split_box_empty();
    count = 0;
    for (int bin = 1; bin < bins->count; bin++) {
        split_box_unite(&box, &bins->boxes[axis][bin - 1]);
        count += bins->triangles[axis][bin - 1];
        const float cost = split_box_area(&box) * (float)count + upper_cost[bin];
        if (count > 0 && count < all && cost < best->cost) {
            best->axis = axis;
            best->bin = bin;
            best->cost = cost;
            best->lower_count = count;
        }
    }
}

static void swap(struct split_triangle *a, struct split_triangle *b)
{
    const struct split_triangle kept = *a;
    *a = *b;
    *b = kept;
}

/* Rearranges the range so that the lower half comes first; returns where the upper begins. */
static size_t part_at(struct split_triangle *triangles, const struct split_range *range,
                      const struct bins *bins, const struct cut *cut)
{
    size_t low = range->first;
    size_t high = range->last;
    for (;;) {
        while (low < high && bin_of(bins, &triangles[low], cut->axis) < cut->bin)
            low++;
        while (low < high && bin_of(bins, &triangles[high - 1], cut->axis) >= cut->bin)
            high--;
        if (low >= high)
            return low;
        swap(&triangles[low++], &triangles[--high]);
    }
}

/* Of equal middles the lower number comes first. */
static bool lies_before(const struct split_triangle *a, const struct split_triangle *b, int axis)
{
    const float at_a = middle(a, axis);
    const float at_b = middle(b, axis);
    return at_a < at_b || (at_a == at_b && a->number < b->number);
}

/* Rearranges the range so that the triangles before `begin` have the lower middles (Hoare's
 * selection). */
static void part_by_order(struct split_triangle *triangles, const struct split_range *range,
                          int axis, size_t begin)
{
    size_t first = range->first;
    size_t last = range->last - 1;
    while (first < last) {
        const struct split_triangle pivot = triangles[first + (last - first) / 2];
        size_t low = first;
        size_t high = last;
        for (;;) {
            while (lies_before(&triangles[low], &pivot, axis))
                low++;
            while (lies_before(&pivot, &triangles[high], axis))
                high--;
            if (low >= high)
                break;
            swap(&triangles[low++], &triangles[high--]);
        }
        if (begin <= high)
            last = high;
        else
            first = high + 1;
    }
}

static int longest_axis(const struct split_box *box)
{
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (extent(box, axis) > extent(box, longest))
            longest = axis;
    return longest;
}

static void set_halves(const struct split_triangle *triangles, struct split_range range,
                       size_t begin, struct split_range *lower, struct split_range *upper)
{
    lower->first = range.first;
    lower->last = upper->first = begin;
    upper->last = range.last;
    lower->box = split_box_of(triangles, lower->first, lower->last);
    upper->box = split_box_of(triangles, upper->first, upper->last);
}

void split_cut_at(struct split_triangle *triangles, const struct split_range *range,
                  size_t lower_count, struct split_range *lower, struct split_range *upper)
{
    const size_t begin = range->first + lower_count;
    part_by_order(triangles, range, longest_axis(&range->box), begin);
    set_halves(triangles, *range, begin, lower, upper);
}

void split_cut(struct split_triangle *triangles, const struct split_range *range, size_t half_limit,
               struct split_range *lower, struct split_range *upper)
{
    const size_t count = range->last - range->first;
    struct bins bins;
    struct cut best = {-1, 0, FLT_MAX, 0};
    set_bins(&bins, triangles, range);
    fill_bins(&bins, triangles, range);
    for (int axis = 0; axis < 3; axis++)
        if (bins.scale[axis] > 0.0f)
            try_axis(&bins, axis, &best);
    if (best.axis < 0 || best.lower_count > half_limit || count - best.lower_count > half_limit)
        split_cut_at(triangles, range, count / 2, lower, upper);
    else
        set_halves(triangles, *range, part_at(triangles, range, &bins, &best), lower, upper);
}
