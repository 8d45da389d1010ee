/* A boulder: a superellipsoid with a relief of waves. It is where f < 0,
 *
 *   f(p) = ((x/a)^4 + (y/b)^4 + (z/c)^4)^(1/4) - 1 + (relief / least of a, b, c) waves(p)
 *
 * parameters: a, b, c (half sizes, m), height of the relief (m), its wavelength (m). */

#define OCTAVES  3
#define SMALLEST 5e-4f /* m: no ray takes shorter steps */

float least_half_size(const float *parameters)
{
    return fmin(fmin(parameters[0], parameters[1]), parameters[2]);
}

/* -2...2 (w) with its gradient over p (xyz); each octave is half as long and half as high. */
float4 waves(float3 p, float wavelength)
{
    float4 sum = (float4)(0.0f);
    float height = 1.0f;
    float wavenumber = 2.0f * M_PI_F / wavelength;
    for (int i = 0; i < OCTAVES; i++) {
        const float3 q = wavenumber * p + (float3)(0.7f, 1.9f, 3.1f) * (float)i;
        const float3 s = (float3)(sin(q.x), sin(q.y), sin(q.z));
        const float3 c = (float3)(cos(q.x), cos(q.y), cos(q.z));
        sum.w += height * (s.x * c.y + s.y * c.z + s.z * c.x) / 3.0f;
        sum.xyz += height * wavenumber / 3.0f *
                   (float3)(c.x * c.y - s.z * s.x, c.y * c.z - s.x * s.y, c.z * c.x - s.y * s.z);
        height *= 0.5f;
        wavenumber *= 2.0f;
    }
    return sum;
}

float f(float3 p, const float *parameters)
{
    const float3 q = p / (float3)(parameters[0], parameters[1], parameters[2]);
    const float3 square = q * q;
    const float smooth = sqrt(sqrt(dot(square, square))) - 1.0f;
    const float share = parameters[3] / least_half_size(parameters);
    if (smooth > 3.0f * share) /* well outside: the least that it can be will do */
        return smooth - 2.0f * share;
    return smooth + share * waves(p, parameters[4]).w;
}

/* Steps that f cannot change its sign in, or the smallest, until it does; then between. */
float shape_distance(float3 point, float3 direction, float nearest, const float *parameters)
{
    const float most = 1.1f * length((float3)(parameters[0], parameters[1], parameters[2]));
    /* |grad f| is at most 1 / (least half size) times this */
    const float slope = 1.0f + 2.0f * M_PI_F * OCTAVES * parameters[3] / parameters[4];
    const float pace = least_half_size(parameters) / slope;
    float near = nearest;
    float f_near = f(point + near * direction, parameters);
    while (near < most) {
        float far = near + fmax(pace * fabs(f_near), SMALLEST);
        float f_far = f(point + far * direction, parameters);
        if ((f_near < 0.0f) == (f_far < 0.0f)) {
            near = far;
            f_near = f_far;
            continue;
        }
        for (int i = 0; i < 20; i++) {
            const float middle = 0.5f * (near + far);
            const float f_middle = f(point + middle * direction, parameters);
            if ((f_middle < 0.0f) == (f_near < 0.0f))
                near = middle;
            else
                far = middle;
        }
        return far;
    }
    return INFINITY;
}

float3 shape_normal(float3 point, const float *parameters)
{
    const float3 size = (float3)(parameters[0], parameters[1], parameters[2]);
    const float3 q = point / size;
    const float3 square = q * q;
    const float norm = sqrt(sqrt(dot(square, square)));
    return square * q / (norm * norm * norm) / size +
           parameters[3] / least_half_size(parameters) * waves(point, parameters[4]).xyz;
}
