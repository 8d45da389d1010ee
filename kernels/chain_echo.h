/* The echo of a chain of sound: from a hit to the source, into bins and strips (kernels/MATH.md,
 * "Chains"). */
#ifndef SONJECT_KERNELS_CHAIN_ECHO_H
#define SONJECT_KERNELS_CHAIN_ECHO_H

#include "chain_hit.h"
#include "tally.h"

/* The way from a hit to the source. */
struct source_path {
    struct vector3 direction;
    vfloat path;      /* m, to the source, or to where it seems to be if layers bend the ray */
    vfloat spreading; /* spreading of the energy on the way, 1/m^2 */
    vfloat range;     /* half the whole path less the reference range, m */
};

/* Returns the way from a point to the receiver at -reference_range * central direction and x. */
FUNCTION struct vector3 to_receiver(const struct fan_record *fan, struct vector3 point, vfloat x)
{
    return vector3_of(x - point.x, -fan->reference_range * fan->cosine_depression - point.y,
                      fan->reference_range * fan->sine_depression - point.z);
}

/* Returns the first leg less the reference range. In focused columns the receiver is not broadside
 * of the first hit, and the leg is longer. */
FUNCTION vfloat first_leg(const struct chain *chain, vfloat receiver_x)
{
    const vfloat shift = chain->first_x - receiver_x;
    const vfloat first = chain->first_reach;
    return chain->range + shift * shift / (SQUARE_ROOT(first * first + shift * shift) + first);
}

/* Returns the receiver's along-track position for the echo of a hit. */
FUNCTION vfloat receiver_of(GLOBAL const struct chain_record *chains, const struct chain *chain)
{
    return chains->is_focused ? 0.5f * (chain->first_x + chain->hit.point.x) : chain->first_x;
}

/* Returns a straight way. Its range is left to be set. */
FUNCTION struct source_path straight_path(struct vector3 to)
{
    struct source_path way;
    way.path = SQUARE_ROOT(dot3(to, to));
    way.spreading = 1.0f / (way.path * way.path);
    const vfloat inverse = 1.0f / way.path;
    way.direction = scaled3(to, inverse);
    way.range = SPLAT(0.0f);
    return way;
}

/* Returns the way to the point (aside, up) of the source's square, which spans x and the fan's
 * central upward direction about the receiver at receiver_x. The length less the reference range R
 * comes without a difference of ranges: |s - p|^2 - R^2 = |p|^2 - 2 s.p + up^2 (+ x^2), with the
 * source s and up across s. */
FUNCTION struct source_path path_to_source(const struct fan_record *fan, const struct chain *chain,
                                           vfloat receiver_x, vfloat aside, vfloat up)
{
    const struct vector3 point = chain->hit.point;
    const float r = fan->reference_range;
    struct vector3 to = to_receiver(fan, point, receiver_x + aside);
    to.y += up * fan->sine_depression;
    to.z += up * fan->cosine_depression;
    struct source_path way = straight_path(to);
    const vfloat height_along = point.y * fan->cosine_depression -
                                point.z * fan->sine_depression; /* p along the central direction */
    const vfloat height_across = point.y * fan->sine_depression + point.z * fan->cosine_depression;
    const vfloat excess = (to.x * to.x + point.y * point.y + point.z * point.z +
                           2.0f * r * height_along - 2.0f * up * height_across + up * up) /
                          (way.path + r);
    way.range = 0.5f * (first_leg(chain, receiver_x) + chain->length + excess);
    return way;
}

/* Works as path_to_source, through layers. The ray is looked up in the upright plane of point and
 * source, then turned to where that plane stands. */
FUNCTION struct source_path path_through_layers(const struct trace *trace,
                                                const struct chain *chain, vfloat receiver_x,
                                                vfloat aside, vfloat up)
{
    const struct fan_record *fan = &trace->fan;
    const struct vector3 point = chain->hit.point;
    const vfloat off = receiver_x + aside - point.x;
    const vfloat broadside = fan->table.ground_range + point.y;
    const vfloat ground = SQUARE_ROOT(broadside * broadside + off * off);
    const struct ray_to_point ray =
        find_ray_to(fan->table, trace->pieces, fan->cosine_depression, fan->sine_depression,
                    point.y + off * off / (ground + broadside), point.z);
    /* The source point lies `up` across the ray, at the distance of the wavefront's radius. */
    const vfloat path = SQUARE_ROOT(ray.wavefront * ray.wavefront + up * up);
    const vfloat level =
        (ray.wavefront * ray.directions.away_y + up * ray.directions.away_z) / path;
    struct source_path way;
    way.path = path;
    way.direction =
        vector3_of(level * off / ground, -level * broadside / ground,
                   (up * ray.directions.away_y - ray.wavefront * ray.directions.away_z) / path);
    way.spreading = ray.spreading / (ground * ray.wavefront);
    way.range =
        0.5f * (first_leg(chain, receiver_x) + chain->length + ray.range + (path - ray.wavefront));
    return way;
}

/* The energies of one group of rays, lane by lane, ready to be tallied. */
struct chain_echo {
    float energy[WIDTH]; /* quanta */
    float dither[WIDTH]; /* uniform deviate for rounding */
    int is_heard[WIDTH]; /* -1: there is some, in bins that exist; 0: there is none */
    int bin[WIDTH];      /* the first of two */
    float later[WIDTH];  /* share of the second */
    int strip[WIDTH], reverse_strip[WIDTH]; /* numbers on the whole track; reverse NO_STRIP: none */
};

#define NO_STRIP (-1073741824)

/* Works as track_strip_at (aspects.h), to 1/16 of a strip: a place closer to a strip's edge may
 * count as the next strip's. The bits of images depend on this. The result is limited, and the
 * tally drops echoes beside it. */
FUNCTION vint strip_at(const struct fan_record *fan, vfloat x)
{
    const vfloat strip = (x - fan->first_strip_x) / fan->strip_width;
    return VINT_OF(smaller(larger(strip, SPLAT(-1.0e6f)), SPLAT(1.0e6f)) + 1000000.5f) - 1000000;
}

FUNCTION void tally_chain_echo(const struct trace *trace, int order, const struct chain_echo *echo)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct chain_record *chains = trace->chains;
    const int plane = order - chains->first_order;
    /* Few lanes are heard, at random. They are listed first, without a branch to be predicted. */
    int heard[WIDTH];
    int count = 0;
    for (int lane = 0; lane < WIDTH; lane++) {
        heard[count] = lane;
        count -= echo->is_heard[lane];
    }
    for (int i = 0; i < count; i++) {
        const int lane = heard[i];
        const float energy = echo->energy[lane];
        const float dither = echo->dither[lane];
        const int strip = echo->strip[lane] - chains->tally_first_strip;
        const int reverse = echo->reverse_strip[lane] - chains->tally_first_strip;
        GLOBAL TALLY *lines = trace->tallies + (LONG_INDEX)plane * chains->tally_strips * fan->bins;
        if (strip >= 0 && strip < chains->tally_strips)
            tally_shares(lines + (LONG_INDEX)strip * fan->bins, fan->bins, 1, echo->bin[lane],
                         echo->later[lane], energy, dither, &trace->outcome->faults);
        if (reverse >= 0 && reverse < chains->tally_strips)
            tally_shares(lines + (LONG_INDEX)reverse * fan->bins, fan->bins, 1, echo->bin[lane],
                         echo->later[lane], energy, dither, &trace->outcome->faults);
    }
    trace->outcome->impulses += (RECORD_WORD)count;
}

/* The ways in which a path counts. A path that began with a specular bounce also stands for its
 * reverse: the reverse would end with that bounce, so nothing finds it. Focused columns see path
 * and reverse from the same place. There a chain from the seabed that ends on a target also stands
 * for its reverse. It is led to the target on purpose; the chain from the target is left out. */
struct ways_counted {
    mask is_counted, counts_reverse;
};

/* Returns where nothing finds a path's reverse, which would begin on the sea surface or on seabed
 * that is lit from there. Fans look at neither. */
FUNCTION mask is_found_one_way(const struct chain *chain)
{
    return MASK_OF(chain->hit.surface == SEA_SURFACE) |
           (MASK_OF(chain->hit.surface == SEABED) & MASK_OF(chain->surface_before == SEA_SURFACE));
}

/* Sets the ways counted if chains meet the sea surface. In `paper` columns reverse paths have
 * connections of their own (connect_reverse). Brute force starts from all seabed. Paths between sea
 * surface and seabed without a target are in the measured image already. */
FUNCTION void count_ways_by_sea_surface(GLOBAL const struct chain_record *chains, int order,
                                        const struct chain *chain, struct ways_counted *ways)
{
    if (chains->estimator == CHAINS_BRUTE_FORCE) {
        ways->counts_reverse = MASK_OF(chain->hit.surface == SEA_SURFACE);
    } else {
        const mask is_alone = is_found_one_way(chain);
        ways->is_counted = ways->is_counted | is_alone;
        ways->counts_reverse =
            chains->is_focused ? ways->counts_reverse | is_alone : ways->counts_reverse & ~is_alone;
    }
    if (order > 1)
        ways->is_counted = ways->is_counted & chain->met_object;
}

FUNCTION struct ways_counted count_ways(GLOBAL const struct chain_record *chains, int order,
                                        const struct chain *chain)
{
    const mask none = chain->is_alive & 0;
    const mask began_on_seabed = MASK_OF(chain->first_surface == SEABED);
    const mask ends_on_seabed = MASK_OF(chain->hit.surface == SEABED);
    struct ways_counted ways;
    ways.is_counted = ~none;
    ways.counts_reverse = chains->estimator == CHAINS_CONNECT ? chain->began_smooth : none;
    if (chains->is_reciprocal) {
        ways.is_counted = ~(~chain->began_smooth & ~began_on_seabed & ends_on_seabed);
        ways.counts_reverse =
            ways.counts_reverse | (~chain->began_smooth & began_on_seabed & ~ends_on_seabed);
        if (order == 2 && chains->cell_samples > 0) { /* paths have the shares of second_order.h */
            ways.counts_reverse = ways.counts_reverse | ~ways.is_counted;
            ways.is_counted = ~none;
        }
    }
    if (has_sea_surface(chains))
        count_ways_by_sea_surface(chains, order, chain, &ways);
    /* One object seen by way of the seabed's specular part belongs to trace_rough_images.h. */
    if (order == 2 && chains->estimator == CHAINS_CONNECT)
        ways.is_counted = ways.is_counted & ~(chain->began_smooth & began_on_seabed);
    return ways;
}

/* Keeps the echo that a hit sends to the source. range: half the path less the reference range. */
FUNCTION void keep_echo(const struct trace *trace, struct ways_counted ways,
                        const struct chain *chain, vfloat energy, vfloat range,
                        vfloat normalisation, struct chain_echo *echo)
{
    const struct fan_record *fan = &trace->fan;
    const mask both = ways.counts_reverse;
    vfloat kept = energy * normalisation;
    const vint none = VINT_OF(SPLAT((float)NO_STRIP));
    const vint strip = strip_at(fan, receiver_of(trace->chains, chain));
    vint reverse;
    if (trace->chains->is_focused) {
        /* A path and its reverse are one echo of twice the amplitude and four times the energy. The
         * factor is 4 if this path counts for both, 2 if the reverse is found too. */
        kept = SELECT(both, kept * 4.0f, kept * 2.0f);
        reverse = none;
    } else {
        reverse = SELECT(both, strip_at(fan, chain->hit.point.x), none);
    }
    kept = SELECT(ways.is_counted & chain->is_alive, kept, SPLAT(0.0f));
    const struct bin_pair bins = bins_about(range * fan->bins_per_metre + fan->bin_at_reference);
    /* An energy that is not a number is heard too, and then reported. */
    const mask is_heard =
        ~MASK_OF(kept <= 0.0f) & MASK_OF(bins.bin >= -1) & MASK_OF(bins.bin < fan->bins);
    STORE_VFLOAT(kept, echo->energy);
    STORE_VFLOAT(chain->dither, echo->dither);
    STORE_VINT(is_heard, echo->is_heard);
    STORE_VINT(bins.bin, echo->bin);
    STORE_VFLOAT(bins.later, echo->later);
    STORE_VINT(strip, echo->strip);
    STORE_VINT(reverse, echo->reverse_strip);
}

#endif
