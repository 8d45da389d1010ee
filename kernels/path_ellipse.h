/* The places of the seabed for which a path from a hit to the receiver has a given length: the
 * section of an ellipsoid with a line across the track (kernels/MATH.md, "Second order"). */
#ifndef SONJECT_KERNELS_PATH_ELLIPSE_H
#define SONJECT_KERNELS_PATH_ELLIPSE_H

#include "fan.h"
#include "vector3.h"

/* A line across the track on the mean seabed, along which y counts from a hit. With the distances d
 * to the hit and r to the receiver, d^2 = square + y^2 and r^2 - d^2 = difference + 2 ground y. */
struct seabed_line {
    vfloat square, difference, ground;
    vfloat direct; /* distance from the hit to the receiver */
};

FUNCTION struct seabed_line line_across(const struct fan_record *fan, struct vector3 hit, vfloat x,
                                        vfloat receiver_x)
{
    const vfloat aside = x - hit.x;
    const vfloat height = hit.z - fan->seabed_height;
    const vfloat receiver_aside = x - receiver_x;
    const float receiver_height = fan->reference_range * fan->sine_depression - fan->seabed_height;
    const vfloat direct_aside = hit.x - receiver_x;
    const vfloat below = receiver_height - height;
    struct seabed_line line;
    line.ground = fan->reference_range * fan->cosine_depression + hit.y;
    line.square = larger(aside * aside + height * height, SPLAT(1.0e-6f));
    line.difference = line.ground * line.ground +
                      (receiver_aside * receiver_aside + receiver_height * receiver_height) -
                      line.square;
    line.direct =
        SQUARE_ROOT(line.ground * line.ground + direct_aside * direct_aside + below * below);
    return line;
}

/* The two places where d + r has a given length: the ellipsoid's section with the line. */
struct section {
    vfloat nearer, farther, middle;
    mask exists;
};

FUNCTION struct section section_of(const struct seabed_line *line, vfloat length)
{
    struct section section;
    const mask is_ellipse = MASK_OF(length > line->direct);
    const vfloat safe = SELECT(is_ellipse, length, 2.0f * line->direct);
    const vfloat inverse = 1.0f / safe;
    const vfloat slope = line->ground * inverse;
    /* d = base - slope y */
    const vfloat base = 0.5f * (safe - line->difference * inverse);
    const vfloat narrow = (safe - line->ground) * (safe + line->ground) * inverse * inverse;
    const vfloat square = base * base - narrow * line->square;
    section.exists = is_ellipse & MASK_OF(square > 0.0f) & MASK_OF(narrow > 0.0f);
    const vfloat share = 1.0f / SELECT(section.exists, narrow, SPLAT(1.0f));
    const vfloat apart = SQUARE_ROOT(SELECT(section.exists, square, SPLAT(0.0f))) * share;
    section.middle = -base * slope * share;
    section.nearer = section.middle - apart;
    section.farther = section.middle + apart;
    return section;
}

/* Returns a place's share, in which places are chosen evenly: about the angle seen from the hit. */
FUNCTION vfloat share_of_place(vfloat y, vfloat depth)
{
    return y / (magnitude(y) + depth);
}

/* The farther side's share, if both have places: parts that the sonar lights rarely face away. */
#define FARTHER_SHARE 0.15f

/* The places on a line whose echoes are in a cell: an interval on the nearer side and one on the
 * farther side, in shares. */
struct places {
    vfloat first, second, first_length;
    vfloat both;     /* sum of both lengths, the farther one times FARTHER_SHARE */
    vfloat boundary; /* y between the two */
    vfloat depth;
    mask exist;
};

FUNCTION struct places places_between(const struct seabed_line *line, vfloat shortest,
                                      vfloat longest, vfloat least_y)
{
    const struct section outer = section_of(line, longest);
    const struct section inner = section_of(line, shortest);
    const vfloat nearest = larger(outer.nearer, least_y);
    const vfloat farthest = larger(outer.farther, least_y);
    const vfloat first_end =
        smaller(larger(SELECT(inner.exists, inner.nearer, outer.middle), nearest), farthest);
    const vfloat second_begin =
        smaller(larger(SELECT(inner.exists, inner.farther, outer.middle), nearest), farthest);
    struct places places;
    places.depth = SQUARE_ROOT(line->square);
    places.first = share_of_place(nearest, places.depth);
    places.second = share_of_place(second_begin, places.depth);
    places.first_length = share_of_place(first_end, places.depth) - places.first;
    places.both =
        larger(places.first_length +
                   FARTHER_SHARE * (share_of_place(farthest, places.depth) - places.second),
               SPLAT(0.0f));
    places.boundary = first_end;
    places.exist = outer.exists & MASK_OF(places.both > 0.0f);
    return places;
}

FUNCTION vfloat sample_place(const struct places *places, vfloat uniform)
{
    const vfloat at = uniform * places->both;
    const vfloat share =
        SELECT(MASK_OF(at < places->first_length), places->first + at,
               places->second + (at - places->first_length) * (1.0f / FARTHER_SHARE));
    const vfloat rest = larger(1.0f - magnitude(share), SPLAT(1.0e-6f));
    return places->depth * share / rest;
}

/* Returns the length of line that a place stands for; 0 if there is none. */
FUNCTION vfloat length_of_place(const struct places *places, vfloat y)
{
    const vfloat far = magnitude(y) + places->depth;
    const vfloat rarer =
        SELECT(MASK_OF(y <= places->boundary), SPLAT(1.0f), SPLAT(1.0f / FARTHER_SHARE));
    return SELECT(places->exist, rarer * places->both * far * far / places->depth, SPLAT(0.0f));
}

#endif
