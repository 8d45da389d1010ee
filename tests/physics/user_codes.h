/* Shapes in OpenCL C for the tests. Helpers of the same name, and names of our own kernels, stand
 * in both on purpose. */
#ifndef SONJECT_TESTS_USER_CODES_H
#define SONJECT_TESTS_USER_CODES_H

/* parameters: radius */
#define SPHERE_DISTANCE                                                                            \
    "#define WIDTH 3\n"                                                                            \
    "struct vector3 { float one; };\n"                                                             \
    "constant float real = 1.0f;\n"                                                                \
    "float helper(float x) { const float FAR_AWAY = real; return x * FAR_AWAY; }\n"                \
    "float shape_distance(float3 p, float3 d, float nearest, const float *a)\n"                    \
    "{\n"                                                                                          \
    "    struct vector3 middle;\n"                                                                 \
    "    middle.one = -dot(p, d);\n"                                                               \
    "    const float3 q = p + d * middle.one;\n"                                                   \
    "    const float square = a[0] * a[0] - dot(q, q);\n"                                          \
    "    if (square < 0.0f) return INFINITY;\n"                                                    \
    "    const float half_chord = helper(sqrt(square));\n"                                         \
    "    if (middle.one - half_chord > nearest) return middle.one - half_chord;\n"                 \
    "    if (middle.one + half_chord > nearest) return middle.one + half_chord;\n"                 \
    "    return INFINITY;\n"                                                                       \
    "}\n"
#define SPHERE_NORMAL "float3 shape_normal(float3 p, const float *a) { return 1e25f * p; }\n"
#define SPHERE_CODE   SPHERE_DISTANCE SPHERE_NORMAL

/* A dome: x^2 + y^2 <= a^2 (h - z) / (2 h), z >= -h. parameters: a, h */
#define DOME_CODE                                                                                  \
    "float helper(float t, float nearest, float so_far) {\n"                                       \
    "    return t > nearest && t < so_far ? t : so_far;\n"                                         \
    "}\n"                                                                                          \
    "float shape_distance(float3 p, float3 d, float nearest, const float *a)\n"                    \
    "{\n"                                                                                          \
    "    float met = INFINITY;\n"                                                                  \
    "    const float k = 0.5f * a[0] * a[0] / a[1];\n"                                             \
    "    const float u = d.x * d.x + d.y * d.y;\n"                                                 \
    "    const float v = p.x * d.x + p.y * d.y + 0.5f * k * d.z;\n"                                \
    "    const float w = p.x * p.x + p.y * p.y - k * (a[1] - p.z);\n"                              \
    "    const float square = v * v - u * w;\n"                                                    \
    "    if (square >= 0.0f) {\n"                                                                  \
    "        const float q = -v - copysign(sqrt(square), v);\n"                                    \
    "        const float t1 = q / u, t2 = w / q;\n"                                                \
    "        if (p.z + t1 * d.z >= -a[1]) met = helper(t1, nearest, met);\n"                       \
    "        if (p.z + t2 * d.z >= -a[1]) met = helper(t2, nearest, met);\n"                       \
    "    }\n"                                                                                      \
    "    const float base = (-a[1] - p.z) / d.z;\n"                                                \
    "    const float3 foot = p + base * d;\n"                                                      \
    "    if (foot.x * foot.x + foot.y * foot.y <= a[0] * a[0]) met = helper(base, nearest, "       \
    "met);\n"                                                                                      \
    "    return met;\n"                                                                            \
    "}\n"                                                                                          \
    "float3 shape_normal(float3 p, const float *a)\n"                                              \
    "{\n"                                                                                          \
    "    const float k = 0.5f * a[0] * a[0] / a[1];\n"                                             \
    "    const float dome = k * (a[1] - p.z) - p.x * p.x - p.y * p.y;\n"                           \
    "    if (p.z + a[1] < fabs(dome) / (2.0f * a[0]))\n"                                           \
    "        return (float3)(0.0f, 0.0f, -1.0f);\n"                                                \
    "    return (float3)(2.0f * p.x, 2.0f * p.y, k);\n"                                            \
    "}\n"

/* Thin, with a normal that points down. parameters: radius */
#define DISC_CODE                                                                                  \
    "float shape_distance(float3 p, float3 d, float nearest, const float *a)\n"                    \
    "{\n"                                                                                          \
    "    const float t = -p.z / d.z;\n"                                                            \
    "    const float3 q = p + t * d;\n"                                                            \
    "    return t > nearest && dot(q, q) <= a[0] * a[0] ? t : INFINITY;\n"                         \
    "}\n"                                                                                          \
    "float3 shape_normal(float3 p, const float *a) { return (float3)(0.0f, 0.0f, -3.0f); }\n"

/* Two spheres side by side along the nose. parameters: radius, half their distance */
#define PAIR_CODE                                                                                  \
    "float one(float3 p, float3 d, float nearest, float radius)\n"                                 \
    "{\n"                                                                                          \
    "    const float middle = -dot(p, d);\n"                                                       \
    "    const float3 q = p + d * middle;\n"                                                       \
    "    const float square = radius * radius - dot(q, q);\n"                                      \
    "    const float half_chord = sqrt(fmax(square, 0.0f));\n"                                     \
    "    if (square < 0.0f) return INFINITY;\n"                                                    \
    "    return middle - half_chord > nearest ? middle - half_chord :\n"                           \
    "           middle + half_chord > nearest ? middle + half_chord : INFINITY;\n"                 \
    "}\n"                                                                                          \
    "float shape_distance(float3 p, float3 d, float nearest, const float *a)\n"                    \
    "{\n"                                                                                          \
    "    const float3 across = (float3)(a[1], 0.0f, 0.0f);\n"                                      \
    "    return fmin(one(p - across, d, nearest, a[0]), one(p + across, d, nearest, a[0]));\n"     \
    "}\n"                                                                                          \
    "float3 shape_normal(float3 p, const float *a)\n"                                              \
    "{\n"                                                                                          \
    "    return p - (float3)(copysign(a[1], p.x), 0.0f, 0.0f);\n"                                  \
    "}\n"

#endif
