/* The coherent part of several smooth faces one after the other: specular bounces, and physical
 * optics at the last hit (kernels/MATH.md, "Multi-bounce specular paths"). The fan leaves one
 * source of a pair, and the echo returns to the other. Both may be the sonar itself. */
#ifndef SONJECT_KERNELS_TRACE_MULTIBOUNCE_H
#define SONJECT_KERNELS_TRACE_MULTIBOUNCE_H

#include "chain_echo.h"
#include "curvature.h"
#include "trace_smooth.h"
#include "tube.h"

/* The return path from the last hit to a source that stands beside the hit along-track. */
struct return_path {
    struct vector3 direction; /* unit, from the hit to the source in unfolded space */
    vfloat length;            /* m */
    vfloat excess;    /* m: range less the source's range, formed without a difference of ranges */
    vfloat spreading; /* spreading of the amplitude, 1/m */
};

/* Works as path_through_layers in chain_echo.h. off: from the hit to the source along-track, m. */
FUNCTION struct return_path return_through_layers(GLOBAL const struct source_record *source,
                                                  GLOBAL const struct ray_piece_record *pieces,
                                                  struct vector3 hit, vfloat off)
{
    const vfloat broadside = source->table.ground_range + hit.y;
    const vfloat ground = SQUARE_ROOT(broadside * broadside + off * off);
    const struct ray_to_point ray =
        find_ray_to(source->table, pieces, source->cosine_depression, source->sine_depression,
                    hit.y + off * off / (ground + broadside), hit.z);
    struct return_path returned;
    returned.direction =
        vector3_of(ray.directions.away_y * off / ground,
                   -ray.directions.away_y * broadside / ground, -ray.directions.away_z);
    returned.length = ray.wavefront;
    returned.excess = ray.range;
    returned.spreading = SQUARE_ROOT(ray.spreading / (ground * ray.wavefront));
    return returned;
}

FUNCTION struct return_path return_path(GLOBAL const struct source_record *source,
                                        GLOBAL const struct ray_piece_record *pieces,
                                        struct vector3 hit, vfloat off)
{
    if (source->table.pieces > 0)
        return return_through_layers(source, pieces, hit, off);
    const float range = source->range;
    const vfloat along = hit.y * source->cosine_depression - hit.z * source->sine_depression;
    const vfloat change = 2.0f * range * along + (off * off + hit.y * hit.y + hit.z * hit.z);
    struct return_path returned;
    returned.length = SQUARE_ROOT(range * range + change);
    returned.excess = change / (returned.length + range);
    returned.spreading = 1.0f / returned.length;
    returned.direction = vector3_of(
        off * returned.spreading, -(range * source->cosine_depression + hit.y) * returned.spreading,
        (range * source->sine_depression - hit.z) * returned.spreading);
    return returned;
}

/* One group of paths under way. */
struct multibounce_path {
    struct chain_hit hit;
    struct tube tube;
    vfloat range;           /* range of the first hit less the outgoing source's range, m */
    vfloat length;          /* path from the first hit to this one, m */
    vfloat first_x;         /* along-track position of the first hit, m */
    vfloat first_reach;     /* reach as in struct chain (chain_hit.h) */
    vfloat first_wavefront; /* width per rad of elevation at the first hit */
    vfloat first_spreading; /* amplitude spreading up to the first hit, 1/m */
    vfloat reflection_real, reflection_imaginary; /* product over all bounces and boundaries */
    mask is_alive;
};

/* The echoes of one group, and their strips on the whole track. */
struct multibounce_echo {
    struct smooth_echo echo;
    int strip[WIDTH];
};

FUNCTION void begin_multibounce(const struct trace *trace, const struct wavefront_cell *cell,
                                struct multibounce_path *path)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct object_record *object = &trace->objects[fan->only_object];
    const struct fan_ray *ray = &cell->ray;
    const struct image_hit first = find_image_hit(trace, FACE_OF_OPTICS, ray, cell->is_ray);
    path->first_wavefront = ray->wavefront + (first.range - ray->range_at_closest);
    path->hit.point = first.point;
    path->hit.normal = first.normal;
    path->hit.back = reversed3(ray->direction);
    path->hit.surface = VINT_OF(SPLAT((float)fan->only_object));
    path->hit.left_behind = is_convex(object) ? path->hit.surface : VINT_OF(SPLAT(-1.0f));
    const struct leg out = follow_leg(trace, &trace->pair->outgoing, start_from(&path->hit),
                                      path->hit.back, path->first_wavefront, first.is_hit);
    trace->outcome->queries += count_lanes(first.is_hit);
    path->is_alive = out.is_open;
    path->hit.is_hit = out.is_open;
    path->reflection_real = out.reflection_real;
    path->reflection_imaginary = out.reflection_imaginary;
    path->range = first.range;
    path->length = SPLAT(0.0f);
    path->first_x = ray->closest.x;
    path->first_reach = fan->reference_range + first.range;
    path->first_spreading = 1.0f / path->first_reach;
    if (fan->table.pieces > 0) {
        const vfloat ground = fan->table.ground_range + first.point.y;
        path->first_reach = ground / ray->direction.y;
        path->first_spreading = SQUARE_ROOT(ray->spreading / (ground * path->first_wavefront));
    }
    const vfloat inverse = 1.0f / path->first_wavefront;
    path->tube.along.offset = vector3_of(SPLAT(1.0f), SPLAT(0.0f), SPLAT(0.0f));
    path->tube.along.turn = zero3();
    path->tube.across.offset = ray->upward;
    path->tube.across.turn =
        vector3_of(SPLAT(0.0f), ray->upward.y * inverse, ray->upward.z * inverse);
}

/* Finds the coherent reflection of the surfaces where the paths are. Paths end on a surface without
 * a smooth part. */
FUNCTION void reflection_of_hit(const struct trace *trace, const struct chain_hit *hit,
                                vfloat cosine, mask *is_alive, vfloat *real_part,
                                vfloat *imaginary_part)
{
    *real_part = SPLAT(0.0f);
    *imaginary_part = SPLAT(0.0f);
    mask is_smooth = *is_alive & 0;
    FOR_SURFACES_MET (i, SEABED, trace->fan.objects, hit->surface, *is_alive) {
        GLOBAL const struct surface_record *surface =
            i < 0 ? &trace->multibounce->seabed : &trace->objects[i].surface;
        const mask here = *is_alive & MASK_OF(hit->surface == i);
        if (!has_smooth_part(surface) || !ANY(here))
            continue;
        vfloat one_real, one_imaginary;
        smooth_reflection(surface, cosine, &one_real, &one_imaginary);
        *real_part = SELECT(here, one_real, *real_part);
        *imaginary_part = SELECT(here, one_imaginary, *imaginary_part);
        is_smooth = is_smooth | here;
    }
    *is_alive = is_smooth;
}

/* Bounces off the hit and follows the way to the next one. */
FUNCTION void bounce_on(const struct trace *trace, struct multibounce_path *path)
{
    const struct chain_hit *hit = &path->hit;
    const vfloat cosine = larger(dot3(hit->normal, hit->back), SPLAT(1.0e-4f));
    const struct vector3 came = reversed3(hit->back);
    vfloat one_real, one_imaginary;
    reflection_of_hit(trace, hit, cosine, &path->is_alive, &one_real, &one_imaginary);
    if (!ANY(path->is_alive))
        return;
    const vfloat was_real = path->reflection_real;
    path->reflection_real = was_real * one_real - path->reflection_imaginary * one_imaginary;
    path->reflection_imaginary = was_real * one_imaginary + path->reflection_imaginary * one_real;
    struct tube_side *sides[2];
    sides[0] = &path->tube.along;
    sides[1] = &path->tube.across;
    for (int i = 0; i < 2; i++) {
        const struct vector3 shift = offset_on_surface(sides[i], came, hit->normal, cosine);
        reflect_side(sides[i], came, hit->normal, cosine, normal_change_at(trace, hit, shift));
    }
    const struct vector3 direction = reflected3(came, hit->normal);
    trace->outcome->queries += count_lanes(path->is_alive);
    const struct chain_hit next = find_chain_hit(trace, FACE_OF_OPTICS, start_from(hit), direction,
                                                 0.0f, hit->left_behind, path->is_alive);
    turn_by_caustics(&path->tube, direction, next.distance, &path->reflection_real,
                     &path->reflection_imaginary);
    transfer_tube(&path->tube, next.distance);
    /* The way begins off the surface, where the wave is later by START_OFF_SURFACE * cosine. */
    path->length = path->length + (next.distance + START_OFF_SURFACE * cosine);
    path->hit = next;
    path->is_alive = next.is_hit & is_narrow(&path->tube);
    /* Paths that have ended stay finite. */
    for (int i = 0; i < 2; i++) {
        sides[i]->offset = choose3(path->is_alive, sides[i]->offset, zero3());
        sides[i]->turn = choose3(path->is_alive, sides[i]->turn, zero3());
    }
}

/* Returns the whole path's gradient along one side of the tube at the last hit. returned: unit, to
 * the source at receiver_x; first_step: move of the first hit along-track. In focused columns the
 * source moves by half the sum of both hits' moves, else with the first hit (kernels/MATH.md,
 * "Multi-bounce specular paths"). */
FUNCTION vfloat path_gradient(const struct multibounce_path *path, const struct tube_side *side,
                              struct vector3 returned, vfloat cosine, float first_step,
                              vfloat receiver_x, int is_focused)
{
    const struct vector3 direction = reversed3(path->hit.back);
    const vfloat onward = dot3(path->hit.normal, side->offset) / cosine;
    const vfloat shift = path->first_x - receiver_x;
    const vfloat reach = SQUARE_ROOT(path->first_reach * path->first_reach + shift * shift);
    const vfloat last_step = side->offset.x + onward * direction.x;
    const vfloat source_step = is_focused ? 0.5f * (first_step + last_step) : SPLAT(first_step);
    return onward * (1.0f - dot3(returned, direction)) - dot3(returned, side->offset) +
           returned.x * source_step + shift / reach * (first_step - source_step);
}

/* Keeps the echo that the last hit returns by physical optics. */
FUNCTION void keep_multibounce_echo(const struct trace *trace, const struct wavefront_cell *cell,
                                    const struct multibounce_path *path,
                                    struct multibounce_echo *kept)
{
    const struct fan_record *fan = &trace->fan;
    const struct chain_hit *hit = &path->hit;
    const vfloat last_x = SELECT(path->is_alive, hit->point.x, path->first_x);
    const vfloat receiver_x =
        trace->multibounce->is_focused ? 0.5f * (path->first_x + last_x) : path->first_x;
    const struct return_path returned =
        return_path(&trace->pair->returning, trace->pieces, hit->point, receiver_x - last_x);
    const vfloat cosine = larger(dot3(hit->normal, hit->back), SPLAT(1.0e-4f));
    const vfloat cosine_return = dot3(hit->normal, returned.direction);
    mask is_lit = path->is_alive & MASK_OF(hit->surface >= 0) & MASK_OF(cosine_return > 0.0f);
    vfloat one_real, one_imaginary;
    reflection_of_hit(trace, hit, 0.5f * (cosine + magnitude(cosine_return)), &is_lit, &one_real,
                      &one_imaginary);
    const struct leg leg = follow_leg(trace, &trace->pair->returning, start_from(hit),
                                      returned.direction, returned.length, is_lit);
    trace->outcome->queries += count_lanes(is_lit);
    const vfloat shift = path->first_x - receiver_x;
    const vfloat first = path->first_reach;
    const vfloat lengthened = shift * shift / (SQUARE_ROOT(first * first + shift * shift) + first);
    const vfloat range = 0.5f * (path->range + lengthened + path->length + returned.excess);
    const vfloat half_path = 0.5f * (fan->reference_range + trace->pair->returning.range) + range;
    struct cell_phase phase = whole_cell(
        fan, integrate_cell(fan, cell,
                            path_gradient(path, &path->tube.along, returned.direction, cosine, 1.0f,
                                          receiver_x, trace->multibounce->is_focused),
                            path_gradient(path, &path->tube.across, returned.direction, cosine,
                                          0.0f, receiver_x, trace->multibounce->is_focused),
                            range, path->first_wavefront));
    const vfloat section =
        magnitude(tube_section(&path->tube, reversed3(hit->back))); /* over the wavefront's */
    const vfloat amplitude = phase.amplitude * (0.5f * trace->pair->echoes) *
                             (1.0f + cosine_return / cosine) * SQUARE_ROOT(section) *
                             (half_path * path->first_spreading) * (half_path * returned.spreading);
    phase.amplitude = larger(smaller(amplitude, SPLAT(QUANTA_LIMIT)), SPLAT(-QUANTA_LIMIT));
    const vfloat product_real =
        path->reflection_real * one_real - path->reflection_imaginary * one_imaginary;
    const vfloat product_imaginary =
        path->reflection_real * one_imaginary + path->reflection_imaginary * one_real;
    put_smooth_echo(
        fan, leg.is_open, phase,
        product_real * leg.reflection_real - product_imaginary * leg.reflection_imaginary,
        product_real * leg.reflection_imaginary + product_imaginary * leg.reflection_real,
        &kept->echo);
    const vint strip = strip_at(fan, receiver_x);
    STORE_VINT(strip, kept->strip);
}

/* Returns the place of the next echo in a list that all work-items share. */
FUNCTION RECORD_WORD next_in_list(GLOBAL RECORD_WORD *listed)
{
#ifdef __OPENCL_C_VERSION__
    return atomic_inc((volatile GLOBAL RECORD_WORD *)listed);
#else
    return __atomic_fetch_add(listed, 1u, __ATOMIC_RELAXED);
#endif
}

/* Lists the echoes that are heard. Echoes lie in few places of a large grid, so the host adds them
 * up. Like tally_add, it reports numbers that cannot be counted. */
FUNCTION void list_multibounce_echo(const struct trace *trace, const struct multibounce_echo *kept)
{
    for (int lane = 0; lane < WIDTH; lane++) {
        struct multibounce_echo_record record;
        record.strip = kept->strip[lane];
        record.bin = kept->echo.bin[lane];
        record.real_part = kept->echo.real_part[lane];
        record.imaginary_part = kept->echo.imaginary_part[lane];
        record.fraction = kept->echo.fraction[lane];
        record.dither = kept->echo.dither[lane];
        if (record.bin < 0)
            continue;
        const float most =
            record.real_part * record.real_part + record.imaginary_part * record.imaginary_part;
        if (most != most)
            trace->outcome->faults |= FAULT_NOT_A_NUMBER;
        else if (most > QUANTA_LIMIT * QUANTA_LIMIT)
            trace->outcome->faults |= FAULT_OVERFLOW;
        else
            trace->echoes[next_in_list(trace->listed)] = record;
        trace->outcome->impulses++;
    }
}

FUNCTION void trace_multibounce_group(const struct trace *trace, int stratum, RECORD_WORD first_ray)
{
    const struct wavefront_cell cell = wavefront_cell_at(trace, stratum, 0.0f, first_ray);
    struct multibounce_path path;
    begin_multibounce(trace, &cell, &path);
    for (int order = 2; order <= trace->multibounce->interactions && ANY(path.is_alive); order++) {
        bounce_on(trace, &path);
        if (!ANY(path.is_alive & MASK_OF(path.hit.surface >= 0)))
            continue;
        struct multibounce_echo kept;
        keep_multibounce_echo(trace, &cell, &path, &kept);
        list_multibounce_echo(trace, &kept);
    }
}

/* Traces the segment of the sub-strip's fan. echoes: room for rays x strata x (interactions - 1) of
 * each sub-strip. */
FUNCTION void trace_multibounce_strip(const struct trace *trace)
{
    for (int stratum = 0; stratum < (int)trace->fan.strata; stratum++)
        for (RECORD_WORD ray = first_ray_of_item(trace); ray < trace->fan.rays;
             ray += ray_step(trace)) {
            count_rays(trace, ray, WIDTH);
            trace_multibounce_group(trace, stratum, ray);
        }
}

#endif
