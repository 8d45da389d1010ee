/* The sea surface within chains of sound (kernels/MATH.md, "Chains by way of the sea surface"). The
 * water below it is straight, without layers. Fans look at the patch and never at the surface. */
#ifndef SONJECT_KERNELS_CHAIN_SEA_SURFACE_H
#define SONJECT_KERNELS_CHAIN_SEA_SURFACE_H

#include "chain_echo.h"
#include "reflectivity_map.h"

/* Puts the hit on the sea surface if a ray meets the surface first. */
FUNCTION void meet_sea_surface(GLOBAL const struct chain_record *chains, struct vector3 start,
                               struct vector3 direction, mask is_ray, struct chain_hit *hit)
{
    const float height = chains->sea_surface_height;
    const mask goes_up = is_ray & MASK_OF(direction.z > 1.0e-6f) & MASK_OF(start.z < height);
    const vfloat distance = (height - start.z) / SELECT(goes_up, direction.z, SPLAT(1.0f));
    const mask is_first = goes_up & (~hit->is_hit | MASK_OF(distance < hit->distance));
    hit->distance = SELECT(is_first, distance, hit->distance);
    const struct vector3 point = along3(start, direction, hit->distance);
    hit->point = choose3(is_first, vector3_of(point.x, point.y, SPLAT(height)), hit->point);
    hit->normal =
        choose3(is_first, vector3_of(SPLAT(0.0f), SPLAT(0.0f), SPLAT(-1.0f)), hit->normal);
    hit->surface = SELECT(is_first, VINT_OF(SPLAT((float)SEA_SURFACE)), hit->surface);
    hit->left_behind = SELECT(is_first, VINT_OF(SPLAT(-1.0f)), hit->left_behind);
    hit->is_hit = hit->is_hit | is_first;
}

/* Ends the chains that cannot be heard any more, because their straight return path comes after the
 * last bin. Also ends those that went from seabed in view of the sonar to the sea surface, since
 * they are found from their other end. order: of the hit before. */
FUNCTION void leave_out_unheard(const struct trace *trace, int order, struct chain *chain)
{
    const struct fan_record *fan = &trace->fan;
    const vfloat shortest =
        0.5f * (chain->range + chain->length + broadside_range(trace, chain->hit.point)) -
        fan->source_side;
    const vfloat bin = shortest * fan->bins_per_metre + fan->bin_at_reference;
    chain->is_alive = chain->is_alive & MASK_OF(bin < (float)fan->bins + 1.0f);
    if (order == 1 && trace->chains->estimator == CHAINS_CONNECT)
        chain->is_alive = chain->is_alive & ~(MASK_OF(chain->first_surface == SEABED) &
                                              MASK_OF(chain->hit.surface == SEA_SURFACE));
}

/* Returns the way to the image of the source's point (aside, up) in the sea surface, formed as in
 * path_to_source: |s - p|^2 - R^2 = |p|^2 - 2 s.p + up^2 + 4 H (H - h) (+ x^2), with the height h
 * of that point and the height H of the surface. */
FUNCTION struct source_path path_to_image(const struct trace *trace, const struct chain *chain,
                                          vfloat receiver_x, vfloat aside, vfloat up)
{
    const struct fan_record *fan = &trace->fan;
    const struct vector3 point = chain->hit.point;
    const float r = fan->reference_range;
    const float surface = trace->chains->sea_surface_height;
    const vfloat source_y = up * fan->sine_depression - r * fan->cosine_depression;
    const vfloat source_z = up * fan->cosine_depression + r * fan->sine_depression;
    const vfloat image_z = 2.0f * surface - source_z;
    const struct vector3 to =
        vector3_of(receiver_x + aside - point.x, source_y - point.y, image_z - point.z);
    struct source_path way = straight_path(to);
    const vfloat excess = (to.x * to.x + point.y * point.y + point.z * point.z -
                           2.0f * (source_y * point.y + image_z * point.z) + up * up +
                           4.0f * surface * (surface - source_z)) /
                          (way.path + r);
    way.range = 0.5f * (first_leg(chain, receiver_x) + chain->length + excess);
    return way;
}

/* Returns where nothing is between a hit and the source's image, on either side of the surface. */
FUNCTION mask is_open_to_image(const struct trace *trace, const struct chain_hit *hit,
                               const struct source_path *way, mask is_way)
{
    const vfloat upward = larger(way->direction.z, SPLAT(1.0e-6f));
    const vfloat to_surface = (trace->chains->sea_surface_height - hit->point.z) / upward;
    const mask is_open = is_open_way(trace, hit, way->direction, to_surface, is_way);
    const struct vector3 bounce = along3(hit->point, way->direction, to_surface);
    struct vector3 down = way->direction;
    down.z = -down.z;
    const vfloat left = way->path - to_surface;
    const struct nearest_hit blocking =
        find_nearest_ahead(trace, bounce, down, 0.0f, left, 1, VINT_OF(SPLAT(-1.0f)), is_open);
    return is_clear_of_relief(trace, bounce, down, left,
                              is_open & MASK_OF(blocking.distance > left));
}

/* Returns the hit's energy to a receiver broadside of receiver_x, straight or by way of the sea
 * surface's specular part, in lanes that want it. It is f cos / r^2 at the source, normalised by
 * the fourth power of half the path (MATH.md). */
NOINLINE vfloat energy_returned(const struct trace *trace, const struct chain *chain,
                                vfloat receiver_x, int by_image, RECORD_WORD draw, mask is_wanted,
                                vfloat *range)
{
    const struct fan_record *fan = &trace->fan;
    const struct chain_hit *hit = &chain->hit;
    vfloat aside = SPLAT(0.0f);
    vfloat up = SPLAT(0.0f);
    if (fan->source_side > 0.0f) {
        two_uniforms(chain->key, chain->number, draw, &aside, &up);
        aside = (aside - 0.5f) * fan->source_side;
        up = (up - 0.5f) * fan->source_side;
    }
    const struct source_path way = by_image ? path_to_image(trace, chain, receiver_x, aside, up)
                                   : fan->table.pieces > 0
                                       ? path_through_layers(trace, chain, receiver_x, aside, up)
                                       : path_to_source(fan, chain, receiver_x, aside, up);
    vfloat scattering = scattering_at(trace, hit, way.direction) * map_factor(trace, hit);
    if (by_image)
        scattering =
            scattering * specular_energy(&trace->chains->sea_surface, magnitude(way.direction.z));
    mask is_open = is_wanted & MASK_OF(scattering > 0.0f);
    if (ANY(is_open)) {
        trace->outcome->queries += count_lanes(is_open) * (by_image ? 2u : 1u);
        is_open = by_image ? is_open_to_image(trace, hit, &way, is_open)
                           : is_open_way(trace, hit, way.direction, way.path, is_open);
    }
    *range = way.range;
    const vfloat half_path = fan->reference_range + way.range;
    const vfloat square = half_path * half_path;
    const vfloat cosine = dot3(hit->normal, way.direction);
    return SELECT(is_open, chain->energy * scattering * cosine * way.spreading * (square * square),
                  SPLAT(0.0f));
}

/* Returns where a path may end on the sea surface's specular part. A single target between
 * boundaries belongs to the pairs of sources (trace_rough_images.h). */
FUNCTION mask may_end_on_boundary(int order, const struct chain *chain)
{
    mask may_end = chain->is_alive & chain->met_object & MASK_OF(chain->hit.surface != SEA_SURFACE);
    if (order == 2)
        may_end = may_end & ~(chain->began_smooth & MASK_OF(chain->first_surface == SEABED));
    return may_end;
}

/* Keeps the echo of paths whose last boundary is the sea surface. The hit is connected through it,
 * and nothing finds the reverse. */
FUNCTION void connect_to_image(const struct trace *trace, int order, const struct chain *chain,
                               RECORD_WORD draw, struct chain_echo *echo)
{
    GLOBAL const struct chain_record *chains = trace->chains;
    struct ways_counted ways;
    ways.is_counted = may_end_on_boundary(order, chain);
    ways.counts_reverse = chains->is_focused ? ways.is_counted : ways.is_counted & 0;
    vfloat range;
    const vfloat energy =
        energy_returned(trace, chain, receiver_of(chains, chain), 1, draw, ways.is_counted, &range);
    keep_echo(trace, ways, chain, energy, range, SPLAT(chains->finer[order - 1]), echo);
}

/* Keeps, in `paper` columns, the echo of a reverse path that nothing finds. Its receiver is
 * broadside of its first hit, this one. A scatterer on the sea surface may be far aside of the
 * target or near the sonar, so both legs are taken anew. The scattering at the other end is not. */
FUNCTION void connect_reverse(const struct trace *trace, int order, const struct chain *chain,
                              int by_image, RECORD_WORD draw, struct chain_echo *echo)
{
    struct ways_counted ways;
    ways.is_counted = by_image ? may_end_on_boundary(order, chain)
                               : chain->is_alive & chain->met_object & is_found_one_way(chain);
    ways.counts_reverse = ways.is_counted;
    const vfloat shift = chain->first_x - chain->hit.point.x;
    const vfloat square = chain->first_reach * chain->first_reach;
    vfloat range;
    const vfloat energy =
        energy_returned(trace, chain, chain->hit.point.x, by_image, draw, ways.is_counted, &range);
    const float finer = by_image ? trace->chains->finer[order - 1] : 1.0f;
    keep_echo(trace, ways, chain, energy, range, finer * square / (square + shift * shift), echo);
    for (int lane = 0; lane < WIDTH; lane++)
        echo->strip[lane] = NO_STRIP;
}

/* Adds the echoes of chains by way of the sea surface to those of every hit. order: of the hit. */
FUNCTION void connect_by_sea_surface(const struct trace *trace, int order,
                                     const struct chain *chain, RECORD_WORD draw)
{
    GLOBAL const struct chain_record *chains = trace->chains;
    struct chain_echo echo;
    const int may_end = has_smooth_part(&chains->sea_surface) && order < chains->interactions;
    if (order < 2)
        return;
    if (!chains->is_focused) {
        connect_reverse(trace, order, chain, 0, draw, &echo);
        tally_chain_echo(trace, order, &echo);
    }
    if (!may_end)
        return;
    connect_to_image(trace, order, chain, draw, &echo);
    tally_chain_echo(trace, order + 1, &echo);
    if (!chains->is_focused) {
        connect_reverse(trace, order, chain, 1, draw, &echo);
        tally_chain_echo(trace, order + 1, &echo);
    }
}

#endif
