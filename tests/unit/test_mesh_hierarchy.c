/* Tests the hierarchy of meshes: every triangle is in one slot, boxes hold all that is below them,
 * the depth is bounded whatever the mesh, and every build gives the same. */
#include "claims.h"
#include "kernel/mesh_samples.h"
#include "mesh/hierarchy.h"

static struct report report;

struct box {
    float lower[3], upper[3];
};

static const struct box empty_box = {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};

static void unite(struct box *box, const struct box *other)
{
    for (int axis = 0; axis < 3; axis++) {
        box->lower[axis] = fminf(box->lower[axis], other->lower[axis]);
        box->upper[axis] = fmaxf(box->upper[axis], other->upper[axis]);
    }
}

/* Expects a box inside another, with room to spare by the padding. */
static void expect_inside(const struct box *inner, const struct box *outer, float padding)
{
    for (int axis = 0; axis < 3; axis++) {
        /* padding is rounded when it is added: half of it is left at the least */
        assert_true(inner->lower[axis] - 0.5f * padding >= outer->lower[axis]);
        assert_true(inner->upper[axis] + 0.5f * padding <= outer->upper[axis]);
    }
}

/* The box of a slot in a rows of faces. */
#define BOX_OF(faces, slot)                                                                        \
    (struct box)                                                                                   \
    {                                                                                              \
        {(faces)[0][slot], (faces)[1][slot], (faces)[2][slot]},                                    \
        {                                                                                          \
            (faces)[3][slot], (faces)[4][slot], (faces)[5][slot]                                   \
        }                                                                                          \
    }

struct tree_check {
    const struct mesh_hierarchy *hierarchy;
    const float *vertices;
    const uint32_t *corners;
    unsigned char *is_seen; /* flags of all triangles */
    size_t seen, leaves, branches;
    float padding;
};

static struct box check_leaf(struct tree_check *check, int number)
{
    const struct mesh_leaf *leaf = &check->hierarchy->leaves[number];
    struct box all = empty_box;
    assert_in_range(leaf->triangles, 1, MESH_SLOTS);
    check->leaves++;
    for (int slot = 0; slot < MESH_SLOTS; slot++) {
        const uint32_t triangle = check->hierarchy->triangles[number * MESH_SLOTS + slot];
        if (slot >= leaf->triangles) {
            assert_int_equal(triangle, MESH_NO_TRIANGLE);
            continue;
        }
        const float *a = &check->vertices[3 * (size_t)check->corners[3 * (size_t)triangle]];
        const float *c = &check->vertices[3 * (size_t)check->corners[3 * (size_t)triangle + 2]];
        const float points[3][3] = {{leaf->a[0][slot], leaf->a[1][slot], leaf->a[2][slot]},
                                    {leaf->b[0][slot], leaf->b[1][slot], leaf->b[2][slot]},
                                    {leaf->c[0][slot], leaf->c[1][slot], leaf->c[2][slot]}};
        struct box box = empty_box;
        for (int corner = 0; corner < 3; corner++)
            for (int axis = 0; axis < 3; axis++) {
                box.lower[axis] = fminf(box.lower[axis], points[corner][axis]);
                box.upper[axis] = fmaxf(box.upper[axis], points[corner][axis]);
            }
        const struct box group = BOX_OF(leaf->group_faces, slot / MESH_GROUP);
        expect_inside(&box, &group, check->padding);
        assert_true(leaf->a[0][slot] == a[0] && leaf->c[2][slot] == c[2]);
        assert_false(check->is_seen[triangle]);
        check->is_seen[triangle] = 1;
        check->seen++;
        unite(&all, &box);
    }
    return all;
}

/* Checks a branch and all below it. MESH_LEVELS, which is tested, bounds the recursion. */
static struct box check_branch(struct tree_check *check, int number, unsigned level)
{
    const struct mesh_branch *branch = &check->hierarchy->branches[number];
    struct box all = empty_box;
    assert_in_range(level, 1, check->hierarchy->levels);
    check->branches++;
    for (int slot = 0; slot < MESH_SLOTS; slot++) {
        const struct box box = BOX_OF(branch->faces, slot);
        const int child = branch->child[slot];
        if (slot % MESH_GROUP >= branch->children[slot / MESH_GROUP]) {
            assert_true(box.lower[0] == MESH_NOWHERE && box.upper[0] == MESH_NOWHERE);
            continue;
        }
        const struct box inside =
            child < 0 ? check_leaf(check, ~child) : check_branch(check, child, level + 1);
        const struct box group = BOX_OF(branch->group_faces, slot / MESH_GROUP);
        expect_inside(&inside, &box, check->padding);
        expect_inside(&inside, &group, check->padding);
        unite(&all, &inside);
    }
    return all;
}

static void check_hierarchy(const char *what, const float *vertices, const uint32_t *corners,
                            size_t triangles, float radius)
{
    struct mesh_hierarchy hierarchy, again;
    EXPECT_OK(&report,
              mesh_hierarchy_build(&report, vertices, corners, triangles, radius, &hierarchy));
    EXPECT_OK(&report, mesh_hierarchy_build(&report, vertices, corners, triangles, radius, &again));
    assert_int_equal(hierarchy.branch_count, again.branch_count);
    assert_int_equal(hierarchy.leaf_count, again.leaf_count);
    assert_memory_equal(hierarchy.branches, again.branches,
                        again.branch_count * sizeof *again.branches);
    assert_memory_equal(hierarchy.leaves, again.leaves, again.leaf_count * sizeof *again.leaves);
    mesh_hierarchy_clear(&again);
    struct tree_check check = {&hierarchy, vertices, corners, zeroed(triangles, 1),
                               0,          0,        0,       MESH_PADDING * radius};
    assert_in_range(hierarchy.levels, 1, MESH_LEVELS);
    check_branch(&check, 0, 1);
    assert_int_equal(check.seen, triangles);
    assert_int_equal(check.leaves, hierarchy.leaf_count);
    assert_int_equal(check.branches, hierarchy.branch_count);
    print_message("%s: %zu triangles, %zu branches, %zu leaves, %u levels\n", what, triangles,
                  hierarchy.branch_count, hierarchy.leaf_count, (unsigned)hierarchy.levels);
    free(check.is_seen);
    mesh_hierarchy_clear(&hierarchy);
}

static void check_sample(const char *what, struct mesh_sample *sample)
{
    float *vertices = zeroed(sample->vertices, 3 * sizeof *vertices);
    for (size_t i = 0; i < 3 * sample->vertices; i++)
        vertices[i] = (float)sample->positions[i];
    check_hierarchy(what, vertices, sample->corners, sample->triangles, 1.2f);
    free(vertices);
    sample_clear(sample);
}

TEST(test_samples)
{
    struct mesh_sample sample;
    sample_box(&sample);
    check_sample("box", &sample);
    sample_sphere(&sample, 5);
    check_sample("sphere", &sample);
    sample_ring(&sample, 300, 200);
    check_sample("ring", &sample);
    sample_litter(&sample, 5000);
    check_sample("litter", &sample);
    for (size_t count = 1; count < 70; count++) {
        sample_litter(&sample, count);
        check_sample("few", &sample);
    }
}

#define MANY 20000

static void check_apart(const char *what, const float *vertices)
{
    static uint32_t corners[3 * MANY];
    for (uint32_t i = 0; i < 3 * MANY; i++)
        corners[i] = i;
    check_hierarchy(what, vertices, corners, MANY, 2.0f);
}

/* All triangles have one middle, so that nothing tells them apart. */
TEST(test_same_middle)
{
    static float vertices[9 * MANY];
    for (size_t i = 0; i < MANY; i++) {
        const float size = (float)(i + 1) / MANY; /* boxes about 0 */
        const float triangle[9] = {-size, -size, -size, size, size, size, size, -size, size};
        memcpy(&vertices[9 * i], triangle, sizeof triangle);
    }
    check_apart("same middle", vertices);
    for (size_t i = 0; i < MANY; i++)
        memcpy(&vertices[9 * i], vertices, 9 * sizeof *vertices);
    check_apart("the same triangle", vertices);
}

/* Each triangle is far smaller and nearer to 0 than the one before, so that the best cut always
 * splits off a few. Without a bound this would take as many levels as there are sizes. */
TEST(test_ever_smaller)
{
    static float vertices[9 * MANY];
    for (size_t i = 0; i < MANY; i++) {
        const float size = ldexpf(1.0f + (float)(i % 100) * 1e-3f, -(int)(i / 160));
        const float triangle[9] = {size, 0.0f, 0.0f, size,       0.1f * size,
                                   0.0f, size, 0.0f, 0.1f * size};
        memcpy(&vertices[9 * i], triangle, sizeof triangle);
    }
    check_apart("ever smaller", vertices);
}

TEST_PROGRAM(NULL, NULL)
