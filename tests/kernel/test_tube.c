/* Tests that a thin tube of rays turns the phase by -pi/2 at each line to which it closes. */
#include "claims.h"
#include "tube.h"

/* Returns a tube along z whose sides close at the given distances, m, or open where negative. The
 * sides may be skew to the axes of the wavefront's curvature. */
static struct tube closing_at(float along, float across, int is_skew)
{
    struct tube tube = {{{1.0f, 0.0f, 0.0f}, {-1.0f / along, 0.0f, 0.0f}},
                        {{0.0f, 1.0f, 0.0f}, {0.0f, -1.0f / across, 0.0f}}};
    if (is_skew) {
        tube.along.offset.y = 1.0f;
        tube.along.turn.y = -1.0f / across;
    }
    return tube;
}

TEST(test_each_line_turns_the_phase)
{
    static const struct {
        float along, across, distance;
        int lines;
    } cases[] = {
        {2.0f, 3.0f, 1.0f, 0},     {2.0f, 3.0f, 2.5f, 1},  {3.0f, 2.0f, 2.5f, 1},
        {2.0f, 3.0f, 4.0f, 2},     {2.0f, 2.0f, 4.0f, 2},  {2.0f, 2.0f, 1.9f, 0},
        {-2.0f, 3.0f, 2.5f, 0},    {-2.0f, 3.0f, 4.0f, 1}, {-2.0f, -3.0f, 9.0f, 0},
        {1e9f, 3.0f, 4.0f, 1},     {1e9f, 1e9f, 4.0f, 0},  {0.5f, 100.0f, 90.0f, 1},
        {0.5f, 100.0f, 110.0f, 2},
    };
    static const float turned[3][2] = {{0.8f, 0.6f}, {0.6f, -0.8f}, {-0.8f, -0.6f}};
    const struct vector3 direction = {0.0f, 0.0f, 1.0f};
    for (size_t i = 0; i < COUNT(cases); i++)
        for (int is_skew = 0; is_skew < 2; is_skew++) {
            const struct tube tube = closing_at(cases[i].along, cases[i].across, is_skew);
            float real_part = 0.8f;
            float imaginary_part = 0.6f;
            turn_by_caustics(&tube, direction, cases[i].distance, &real_part, &imaginary_part);
            if (real_part != turned[cases[i].lines][0] ||
                imaginary_part != turned[cases[i].lines][1])
                fail_msg("case %zu: %g + %g i", i, (double)real_part, (double)imaginary_part);
        }
}

TEST_PROGRAM(NULL, NULL)
