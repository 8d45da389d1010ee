/* What is to be drawn so that injected contacts measure as real ones do: sizes, levels and the
 * noise floor are moved until quantiles of what both show agree. Formulas: kernels/MATH.md, "Fit".
 */
#ifndef SONJECT_MEASURE_DRAW_FIT_H
#define SONJECT_MEASURE_DRAW_FIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/result.h>

#include "base/report.h"

/* What is moved. Lengths are natural logarithms of m, levels dB. */
enum fitted {
    FITTED_LENGTH, /* overall, along the nose */
    FITTED_WIDTH,
    FITTED_HEIGHT, /* above the seabed */
    FITTED_LEVEL,  /* of the echo's peak over the seabed */
    FITTED_FLOOR,  /* noise over the seabed */
    FITTED_KINDS
};

/* What is compared. Extents are natural logarithms of m. */
enum extent {
    EXTENT_HIGHLIGHT_ALONG,
    EXTENT_HIGHLIGHT_RANGE, /* on the ground */
    EXTENT_SHADOW_ALONG,
    EXTENT_SHADOW_HEIGHT, /* that would throw a shadow of this length */
    EXTENT_AXIS_LENGTH,
    EXTENT_AXIS_WIDTH,
    EXTENT_HIGHLIGHT_ROWS, /* of the boxes around highlight and shadow */
    EXTENT_HIGHLIGHT_COLUMNS,
    EXTENT_SHADOW_ROWS,
    EXTENT_HIGHLIGHT_SLANT, /* in slant range, as it is published */
    EXTENT_SHADOW_SLANT,
    EXTENT_LENGTHS, /* those above are lengths, those below dB over the seabed */
    EXTENT_HIGHLIGHT_LEVEL = EXTENT_LENGTHS,
    EXTENT_SHADOW_LEVEL,
    EXTENT_KINDS
};

/* A contact as it is measured; NaN: not seen. */
struct contact_extents {
    double of[EXTENT_KINDS];
    double highlight_visibility_db, shadow_visibility_db;
    double pad_pixels;          /* by which its label is wider than what shows, on each side */
    double range_over_altitude; /* of the label's middle */
};

/* An injected contact: what was drawn, and what it shows. */
struct drawn_contact {
    double drawn[FITTED_KINDS];
    double now[FITTED_KINDS]; /* what its draws have become since, by later rounds' moves */
    double heading_rad;
    struct contact_extents shown; /* by what was drawn */
    uint32_t round;               /* in which it was made, from 0 */
    bool is_faint;                /* seen less than real ones are */
};

#define QUANTILES_MAX 32
#define SEEN_LEAST    8 /* contacts that show an extent, for it to be compared */

/* What real contacts show. */
struct quantile_goal {
    size_t levels; /* 0: it is not compared */
    double level[QUANTILES_MAX], value[QUANTILES_MAX];
    double error[QUANTILES_MAX]; /* standard, of the values */
};

/* How a kind of draw is moved: around the mean of what was drawn, x becomes
 * centre + shift + stretch (x - centre). */
struct draw_move {
    double centre, shift, stretch;
};

/* What is known of the moves before: how far they have gone so far, and how far the campaign's own
 * values are to be believed. */
struct move_prior {
    double shift[FITTED_KINDS];   /* so far */
    double stretch[FITTED_KINDS]; /* natural logarithm, so far */
    double contacts;              /* real ones */
};

/* The quantiles of what real contacts show: 5 to 95 % from 100 contacts, 20 to 80 % below 30.
 * goals: EXTENT_KINDS. Errors: MEMORY. */
sonject_status quantile_goals(struct report *report, const struct contact_extents *contacts,
                              size_t count, struct quantile_goal *goals);

/* The standard error of the value below which a share of contacts lies, of so many whose middle
 * half is so wide; after a normal distribution's. */
double quantile_error(double share, double middle_half, double count);

/* The value below which a share lies of what ascending values were drawn from, as often too low as
 * too high (Hyndman and Fan's eighth); those of few would else lie too far inside. */
double sorted_quantile(const double *sorted, size_t count, double share);

/* What a value becomes. */
double draw_moved(const struct draw_move *move, double value);

/* One round: how to move draws so that contacts, round after round, whose draws have become what
 * `now` says, show what the goals say. Rounds whose draws have hardly moved are compared; all tell
 * how what is shown follows from what is drawn, the nearer the better. moves: FITTED_KINDS. Errors:
 * MEMORY, INPUT (too few contacts are seen). */
sonject_status fit_moves(struct report *report, const struct drawn_contact *contacts, size_t count,
                         const struct quantile_goal *goals, const struct move_prior *prior,
                         struct draw_move *moves);

#endif
