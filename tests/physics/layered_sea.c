#include "layered_sea.h"

#define LEVEL_DB 0.2
#define PHASE    0.05 /* rad; stationary phase errs by 1/(2ka), 1/126 for a = 0.15 m */

struct sea *layered_sea_open(size_t rows, size_t columns, double middle_range_m,
                             const struct water_layer *layers, size_t count)
{
    struct sea *sea = sea_open(rows, columns, middle_range_m);
    sea->sonar->altitude_m = ALTITUDE;
    sea->medium->reference_sound_speed_mps = REFERENCE;
    sea_set_layers(sea, layers, count);
    return sea;
}

uint32_t bounces_of(enum image_of_sonar image)
{
    return image == SONAR ? 0 : image <= BY_SURFACE ? 1 : 2;
}

static double reference_speed(const struct sea *sea)
{
    const double speed = sea->medium->reference_sound_speed_mps;
    return speed > 0.0 ? speed : sea->medium->sound_speed_mps;
}

struct reference_way way_from(const struct sea *sea, enum image_of_sonar image)
{
    struct reference_way way;
    way.layers = sea->bench->water.layers;
    way.count = sea->bench->water.count;
    way.sonar_height = sea->sonar->altitude_m;
    way.depth = sea->surface->water_depth_m;
    way.bounces = bounces_of(image);
    way.comes_from_seabed = image == BY_SEABED || image == BY_SURFACE_AND_SEABED;
    return way;
}

struct reference_sound sound_from(const struct sea *sea, enum image_of_sonar image, double range,
                                  double height)
{
    const struct reference_way way = way_from(sea, image);
    return reference_sound_at(&way, range, height);
}

struct reference_sound sound_on_seabed(const struct sea *sea, double processor_range, double *area)
{
    const double speed = reference_speed(sea);
    const struct reference_way way = way_from(sea, SONAR);
    const long double p = reference_parameter_of_time(&way, processor_range / speed);
    const double length = sqrt(PI / (4.0 * log(2.0))) * speed / (2.0 * sea->sonar->bandwidth_hz);
    *area = sea->geometry->row_spacing_m * length / (speed * (double)p);
    return reference_sound_at(&way, (double)reference_sum(&way, 0.0, p).range, 0.0);
}

/* Returns p = cos/c of sound at a target. It is the same all along the path. */
static double parameter_of(const struct sea *sea, struct reference_sound sound)
{
    return cos(sound.grazing) / sea->bench->water.layers[0].speed_mps;
}

/* Returns the share of the energy that all planes under the sonar pass on, one way: 1 - R^2 = 4 Z1
 * Z2 / (Z1 + Z2)^2 with Z = density c / sin. Planes of a profile have no step of density and pass
 * all. */
static double passed_on(const struct sea *sea, double p)
{
    const struct water_layer *layer = sea->bench->water.layers;
    double share = 1.0;
    for (size_t i = 0; i + 1 < sea->bench->water.count; i++, layer++) {
        double impedance[2];
        for (int side = 0; side < 2; side++)
            impedance[side] = layer[side].density * layer[side].speed_mps /
                              sqrt(1.0 - pow(p * layer[side].speed_mps, 2.0));
        if (layer[0].density != layer[1].density && layer[1].bottom_m < sea->sonar->altitude_m)
            share *= 4.0 * impedance[0] * impedance[1] / pow(impedance[0] + impedance[1], 2.0);
    }
    return share;
}

double gain_of(const struct sea *sea, struct reference_sound out, struct reference_sound home)
{
    const double passed =
        passed_on(sea, parameter_of(sea, out)) * passed_on(sea, parameter_of(sea, home));
    return pow(reference_speed(sea) * 0.5 * (out.time + home.time), 2.0) *
           sqrt(out.out * home.home * passed);
}

/* Returns the Rayleigh coefficient of a mirror times exp(-2 (k eta sin)^2), the share that
 * roughness eta leaves. k and angle are those at the mirror: k sin = 2 pi f sqrt(1/c^2 - p^2). */
static double complex mirror_of(const struct sea *sea, const sonject_material_params *material,
                                double speed, double p)
{
    const double sine = sqrt(1.0 - p * p * speed * speed);
    const double k_sine = 2.0 * PI * sea->sonar->centre_frequency_hz / speed * sine;
    double complex reflection = material->reflection;
    if (material->reflection_kind == SONJECT_REFLECTION_FLUID) {
        const double complex index = (1.0 + I * material->loss) / material->speed_ratio;
        const double complex root = csqrt(index * index - (1.0 - sine * sine));
        reflection =
            (material->density_ratio * sine - root) / (material->density_ratio * sine + root);
    }
    return reflection * exp(-2.0 * pow(k_sine * material->roughness_m, 2.0));
}

static double complex mirrors_of(const struct sea *sea, enum image_of_sonar image,
                                 struct reference_sound sound)
{
    const struct reference_way way = way_from(sea, image);
    const double p = parameter_of(sea, sound);
    double complex product = 1.0;
    if (image == BY_SEABED || way.bounces == 2)
        product *= mirror_of(sea, &sea->seabed->forward, reference_speed_at(&way, 0.0), p);
    if (image == BY_SURFACE || way.bounces == 2)
        product *= mirror_of(sea, &sea->surface->material, reference_speed_at(&way, way.depth), p);
    return product;
}

struct pair {
    const struct sea *sea;
    enum image_of_sonar out, home;
    double radius;
};

/* Returns half the travel time by way of a point of the sphere. */
static double half_time(double angle, const void *context)
{
    const struct pair *pair = context;
    const double *centre = sea_centre(pair->sea, 0);
    const double y = centre[1] - pair->radius * cos(angle);
    const double z = centre[2] + pair->radius * sin(angle);
    return 0.5 * (sound_from(pair->sea, pair->out, y, z).time +
                  sound_from(pair->sea, pair->home, y, z).time);
}

struct family family_of(const struct sea *sea, enum image_of_sonar out, enum image_of_sonar home)
{
    const double a = 0.5 * sea_object(sea, 0)->diameter_m;
    const struct pair pair = {sea, out, home, a};
    const double angle = least_at(half_time, &pair, -0.5 * PI, 0.5 * PI);
    const double y = sea_centre(sea, 0)[1] - a * cos(angle);
    const double z = sea_centre(sea, 0)[2] + a * sin(angle);
    const struct reference_sound there = sound_from(sea, out, y, z);
    const struct reference_sound back = sound_from(sea, home, y, z);
    const double time = 0.5 * (there.time + back.time);
    struct family family;
    family.range = reference_speed(sea) * time;
    family.amplitude = 0.5 * a * gain_of(sea, there, back) * mirrors_of(sea, out, there) *
                       mirrors_of(sea, home, back) *
                       cexp(4.0 * I * PI * sea->sonar->centre_frequency_hz * time);
    return family;
}

static bool has_image(const struct sea *sea, enum image_of_sonar image)
{
    const sonject_material_params *seabed = &sea->seabed->forward;
    const bool has_seabed =
        seabed->reflection_kind == SONJECT_REFLECTION_FLUID || seabed->reflection != 0.0;
    const bool has_surface = sea->surface->water_depth_m > 0.0;
    return image == SONAR || (image == BY_SEABED    ? has_seabed
                              : image == BY_SURFACE ? has_surface
                                                    : has_seabed && has_surface);
}

void expect_families(const struct sea *sea, const struct line *line, uint32_t bounces)
{
    struct family families[IMAGES * IMAGES];
    uint32_t met[IMAGES * IMAGES];
    size_t count = 0;
    for (enum image_of_sonar out = SONAR; out < IMAGES; out++)
        for (enum image_of_sonar home = SONAR; home < IMAGES; home++) {
            met[count] = bounces_of(out) + bounces_of(home);
            if (met[count] < sea->injection->interactions && has_image(sea, out) &&
                has_image(sea, home))
                families[count++] = family_of(sea, out, home);
        }
    const double half_radius = 0.25 * sea_object(sea, 0)->diameter_m;
    for (size_t i = 0; i < count; i++) {
        const double range = families[i].range;
        if (met[i] > bounces || sea_column(sea, range) > (double)sea->columns)
            continue;
        double complex expected = 0.0;
        for (size_t k = 0; k < count; k++)
            expected += families[k].amplitude * sea_pulse(sea, range - families[k].range);
        const double complex measured = line_at(sea, line, range);
        print_message("%u bounces, range %.3f m\n", (unsigned)met[i], range);
        expect_close("level re a/2, dB", decibels_of_amplitude(cabs(measured) / half_radius),
                     decibels_of_amplitude(cabs(expected) / half_radius), LEVEL_DB);
        expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
    }
}

/* Returns a Lambert sphere's energy, seen at an angle from the source, over that at no angle. */
static double lambert_sphere(double angle)
{
    return (sin(angle) + (PI - angle) * cos(angle)) / PI;
}

double rough_ratio(const struct sea *sea, enum image_of_sonar image, double reflection)
{
    const double *centre = sea_centre(sea, 0);
    const struct reference_sound straight = sound_from(sea, SONAR, centre[1], centre[2]);
    const struct reference_sound bent = sound_from(sea, image, centre[1], centre[2]);
    const double unit = pow(gain_of(sea, straight, straight), 2.0);
    return 1.0 +
           4.0 * pow(reflection, 2.0) * lambert_sphere(fabs(straight.grazing - bent.grazing)) *
               pow(gain_of(sea, bent, straight), 2.0) / unit +
           pow(reflection, 4.0) * pow(gain_of(sea, bent, bent), 2.0) / unit;
}
