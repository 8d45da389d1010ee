/* The fit of a campaign's draws: sizes, levels and the noise floor are moved until injected
 * contacts have the same quantiles of measures as real ones. Formulas: kernels/MATH.md, "Fit". */
#ifndef SONJECT_MEASURE_DRAW_FIT_H
#define SONJECT_MEASURE_DRAW_FIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/result.h>

#include "base/report.h"

/* The draws that are moved. Lengths are natural logarithms of m, levels dB. */
enum fitted {
    FITTED_LENGTH, /* overall length, along the nose */
    FITTED_WIDTH,
    FITTED_HEIGHT, /* above the seabed */
    FITTED_LEVEL,  /* the echo's peak over the seabed */
    FITTED_FLOOR,  /* noise over the seabed */
    FITTED_KINDS
};

/* The measures that are compared. Extents are natural logarithms of m. */
enum extent {
    EXTENT_HIGHLIGHT_ALONG,
    EXTENT_HIGHLIGHT_RANGE, /* on the ground */
    EXTENT_SHADOW_ALONG,
    EXTENT_SHADOW_HEIGHT, /* height that would throw a shadow of this length */
    EXTENT_AXIS_LENGTH,
    EXTENT_AXIS_WIDTH,
    EXTENT_HIGHLIGHT_ROWS, /* here and below: boxes around highlight and shadow */
    EXTENT_HIGHLIGHT_COLUMNS,
    EXTENT_SHADOW_ROWS,
    EXTENT_HIGHLIGHT_SLANT, /* here and below: in slant range, as published */
    EXTENT_SHADOW_SLANT,
    EXTENT_LENGTHS, /* above are lengths, below are dB over the seabed */
    EXTENT_HIGHLIGHT_LEVEL = EXTENT_LENGTHS,
    EXTENT_SHADOW_LEVEL,
    EXTENT_KINDS
};

/* The measures of a contact; NaN: not seen. */
struct contact_extents {
    double of[EXTENT_KINDS];
    double highlight_visibility_db, shadow_visibility_db;
    double pad_pixels;          /* margin of the label around the visible contact, on each side */
    double range_over_altitude; /* ratio at the label's middle */
    bool is_shadow_cut;         /* the shadow reaches the image's edge */
};

/* An injected contact: its draws and its measures. */
struct drawn_contact {
    double drawn[FITTED_KINDS];
    double now[FITTED_KINDS]; /* the draws after later rounds' moves */
    double heading_rad;
    struct contact_extents shown; /* measures for `drawn` */
    uint32_t round;               /* round in which the contact was made, from 0 */
    bool is_faint;                /* seen less well than real ones */
};

#define QUANTILES_MAX 32
#define SEEN_LEAST    8 /* fewest contacts that show an extent that is compared */

/* The quantiles of real contacts. */
struct quantile_goal {
    size_t levels; /* 0: the extent is not compared */
    double level[QUANTILES_MAX], value[QUANTILES_MAX];
    double error[QUANTILES_MAX]; /* standard errors of the values */
};

/* A move of draws: about the mean `centre`, x becomes centre + shift + stretch (x - centre). */
struct draw_move {
    double centre, shift, stretch;
};

/* The prior of a round's moves: the sum of earlier moves, and the number of real contacts. */
struct move_prior {
    double shift[FITTED_KINDS];   /* sum so far */
    double stretch[FITTED_KINDS]; /* sum so far, natural logarithm */
    double contacts; /* number of real ones; with few, the campaign's spreads count more */
    double moves;    /* number of earlier moves; the n-th is at most 1/n as large as the first */
};

/* Finds the quantiles of real contacts: 5 to 95 % of 90 or more that show an extent, 20 to 80 %
 * below 27. goals: EXTENT_KINDS. Errors: MEMORY. */
sonject_status quantile_goals(struct report *report, const struct contact_extents *contacts,
                              size_t count, struct quantile_goal *goals);

/* Returns the standard error of a quantile of `count` contacts, for a normal distribution whose
 * middle half has this width. */
double quantile_error(double share, double middle_half, double count);

/* Returns the quantile, at a share, of the distribution that ascending values come from, as often
 * too low as too high (Hyndman and Fan's eighth). Others, from few values, lie too far inside. */
double sorted_quantile(const double *sorted, size_t count, double share);

/* Returns that quantile of the finite values; NaN: there are none. Moves these to the front and
 * sorts them. */
double finite_quantile(double *values, size_t count, double share);

/* Returns the value that a move makes of a value. */
double draw_moved(const struct draw_move *move, double value);

/* Runs one round: finds the moves that make contacts show what the goals say. `now` has the draws
 * after the moves of earlier rounds. Rounds whose draws have hardly moved are compared with the
 * goals. All rounds tell how measures follow from draws, weighted by nearness. moves: FITTED_KINDS.
 * Errors: MEMORY, INPUT (too few contacts are seen). */
sonject_status fit_moves(struct report *report, const struct drawn_contact *contacts, size_t count,
                         const struct quantile_goal *goals, const struct move_prior *prior,
                         struct draw_move *moves);

#endif
