/* The fit of a campaign to contacts (sonject fit). Labels are read, contacts measured, draws moved,
 * chips made and measured again, and a campaign file and a page written. */
#ifndef SONJECT_DATASET_FIT_H
#define SONJECT_DATASET_FIT_H

#include <sonject/campaign.h>

#include "dataset/campaign.h"
#include "dataset/contact_files.h"
#include "measure/draw_fit.h"

/* ---- The measuring of contacts, alike for real and injected ones (fit_contacts.c). */

/* Intensities cut out around a contact. */
struct contact_chip {
    float *intensity; /* rows x columns; owned */
    size_t rows, columns;
    double row_spacing_m, column_spacing_m;
    double first_slant_range_m, altitude_m; /* slant range of column 0, from which range grows */
    sonject_box label;
    size_t swath; /* number of the campaign's swath that shows the contact; SIZE_MAX: none */
};

void contact_chip_clear(struct contact_chip *chip);

/* Finds the side on which each label lies, and where range grows to the left, as the campaign's
 * scene reads the images. Errors: those of scenes and swaths. */
sonject_status contact_set_place(struct sonject_campaign *campaign, struct contact_set *set);

/* Cuts a placed contact out of its image, which the campaign's scene reads. Geometry and altitude
 * are the image's own where the image gives them. Errors: those of scenes and swaths. */
sonject_status contact_chip_read(struct sonject_campaign *campaign, const char *image,
                                 const struct labelled_contact *contact, struct contact_chip *chip);

/* Cuts out the target of a campaign's image. pad: pixels by which a label is wider than the part
 * that it is around. *is_seen: set if there is anything to label. Errors: MEMORY. */
sonject_status contact_chip_of_image(struct report *report, const struct campaign_image *image,
                                     uint32_t part, uint64_t pad, struct contact_chip *chip,
                                     bool *is_seen);

/* Measures the contact; NaN where nothing is found. Errors: MEMORY. */
sonject_status contact_chip_measure(struct report *report, const struct contact_chip *chip,
                                    uint32_t part, struct contact_extents *extents);

/* ---- The draws that are moved (fit_draws.c). */

#define FIT_KEY_CAPACITY 96

/* A number in the campaign's file that the fit moves. */
struct fitted_number {
    const struct tree_node *node; /* node of the campaign's tree */
    double start, value;          /* values in the unit as written */
    char unit[16];                /* see struct distribution */
    double unit_scale;            /* metres in a unit of length; 1 for dB */
    uint32_t kinds;               /* bits of 1 << enum fitted */
    uint32_t of_kinds;            /* kinds of the number that this is a ratio of; 0: not a ratio */
    bool is_deviation; /* deviation of a normal distribution; the number before is its mean */
    char key[FIT_KEY_CAPACITY]; /* "targets[0].draw.length" */
};

/* The other values that a fit sets. NaN, and limits of 0: the value stays. */
struct fitted_selection {
    double highlight_db, shadow_db; /* thresholds of visible */
    struct ratio_limits chip;       /* limits for chips */
    struct ratio_limits *swaths;    /* limits of each swath; NULL: none */
};

#define FITTED_BIT(kind) (UINT32_C(1) << (kind))

/* The draws that a fit moves; the campaign must outlive them. Starts as zeros; for fit_draws_clear.
 */
struct fit_draws {
    uint32_t unseen; /* kinds that the contacts do not show, as FITTED_BIT: they stay */
    const struct campaign *campaign; /* borrowed */
    char *text;                      /* text of the campaign's file; owned */
    struct fitted_number *numbers;   /* owned */
    size_t count;
    bool lacks_level[CAMPAIGN_ITEMS_MAX]; /* targets that do not draw a level */
    bool lacks_floor;
    bool has_added;                /* the lacking draws have values so far: */
    double level_db[2], floor_db;  /* levels between these, and this floor */
    struct growing_text unchanged; /* keys of targets' draws that stay, one a line; owned */
    struct growing_text fixed;     /* note on targets whose sizes the fit cannot move; owned */
};

/* Lists the numbers of a campaign that fit can move. Errors: INPUT (levels by target strength, a
 * number that --set gives), STORAGE, MEMORY. */
sonject_status fit_draws_find(struct fit_draws *draws, struct report *report,
                              const struct campaign *campaign);
void fit_draws_clear(struct fit_draws *draws);

/* Moves all numbers and the added draws. */
void fit_draws_move(struct fit_draws *draws, const struct draw_move *moves);

/* Makes the campaign's text, comments included, with the moved numbers in it. comment: lines to put
 * before. *text: for free(). Errors: INPUT (a key cannot be added there), MEMORY. */
sonject_status fit_draws_text(const struct fit_draws *draws, struct report *report,
                              const struct fitted_selection *selection, const char *comment,
                              char **text);

/* ---- The whole (fit.c), its rounds (fit_rounds.c) and its page (fit_page.c). */

#define FIT_CHIPS  104 /* chips in a round */
#define FIT_ROUNDS 12  /* rounds; the last one only shows the result */
#define FIT_SHOWN  20  /* real chips on the page, and as many injected ones */

/* All data of the page. */
struct fit {
    struct report *report;
    struct campaign_source source; /* source of the campaign that is fitted */
    char folder[PATH_CAPACITY];    /* folder for calibrations that the scene asks for */
    struct contact_choice choice;
    struct sonject_campaign *campaign; /* campaign as in its file */
    struct contact_set set;
    struct contact_extents *real; /* owned */
    size_t *swaths;               /* swath of each real contact; owned */
    size_t real_count;            /* measured contacts; 0 for quantiles */
    struct quantile_goal goals[EXTENT_KINDS];
    struct drawn_contact *made; /* contacts of all rounds; owned */
    size_t made_count;
    uint64_t pad; /* pixels by which labels of injected contacts are widened, to match real ones */
    struct contact_chip real_chips[FIT_SHOWN], made_chips[FIT_SHOWN];
    size_t real_chip_count, made_chip_count;
    struct fit_draws draws;
    struct fitted_selection selection;
    struct growing_text notes; /* notes on the page, one a line; owned */
};

/* Tells a note in the log and on the page. */
void fit_note(struct fit *fit, const char *note);

/* Runs all rounds: makes and measures contacts, and moves the draws. progress: NULL, or called with
 * `user`. Errors: those of campaigns, CANCELLED. */
sonject_status fit_run_rounds(struct fit *fit, struct device_slot *slot,
                              sonject_progress_function progress, void *user);

/* Fits a campaign; see sonject_campaign_fit, also for errors. */
sonject_status campaign_fit(struct report *report, struct device_slot *slot,
                            const struct campaign_source *source,
                            const sonject_campaign_fit_params *params,
                            sonject_progress_function progress, void *user);

/* Makes the name of the fitted campaign's file with another extension, such as ".html". Errors:
 * STORAGE (the name is too long). */
sonject_status fit_page_name(struct report *report, const char *fitted, const char *extension,
                             char path[PATH_CAPACITY]);

/* Writes the page, "<fitted without extension>.html", and its picture ".png". Errors: STORAGE,
 * MEMORY. */
sonject_status fit_page_write(const struct fit *fit, const char *fitted);

#endif
