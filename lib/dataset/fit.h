/* A campaign fitted to contacts: what sonject fit does. Labels are read, contacts measured, draws
 * moved, chips made and measured again, and a campaign file and a page written. */
#ifndef SONJECT_DATASET_FIT_H
#define SONJECT_DATASET_FIT_H

#include <sonject/campaign.h>

#include "dataset/campaign.h"
#include "dataset/contact_files.h"
#include "measure/draw_fit.h"

/* ---- Contacts as they are measured, real and injected by one ruler (fit_contacts.c). */

/* An image of intensities with a contact in it, cut out around it. */
struct contact_chip {
    float *intensity; /* rows x columns; owned */
    size_t rows, columns;
    double row_spacing_m, column_spacing_m;
    double first_slant_range_m, altitude_m; /* of column 0, from which range grows */
    sonject_box label;
    size_t swath; /* number of the campaign's that shows it; SIZE_MAX: none does */
};

void contact_chip_clear(struct contact_chip *chip);

/* Cuts a labelled contact out of its image, as the campaign's scene reads such an image; geometry
 * and altitude are the image's own where it tells them. Errors: as scenes and swaths. */
sonject_status contact_chip_read(struct sonject_campaign *campaign, const char *image,
                                 const struct labelled_contact *contact, struct contact_chip *chip);

/* The chip around the target of a campaign's image; pad: pixels by which labels are wider than what
 * they are around. *is_seen: whether there is anything to label. Errors: MEMORY. */
sonject_status contact_chip_of_image(struct report *report, const struct campaign_image *image,
                                     uint32_t part, uint64_t pad, struct contact_chip *chip,
                                     bool *is_seen);

/* What the contact shows; NaN where nothing is found. Errors: MEMORY. */
sonject_status contact_chip_measure(struct report *report, const struct contact_chip *chip,
                                    uint32_t part, struct contact_extents *extents);

/* ---- The draws that are moved (fit_draws.c). */

#define FIT_KEY_CAPACITY 96

/* A number in the campaign's file that is moved. */
struct fitted_number {
    const struct tree_node *node; /* of the campaign's tree */
    double start, value;          /* in the unit as it is written */
    char unit[16];                /* as of a distribution */
    double unit_scale;            /* of a length to m; 1 for dB */
    uint32_t kinds;               /* bits of 1 << enum fitted */
    uint32_t of_kinds;            /* not 0: it is a ratio of what has these */
    bool is_deviation;            /* of a normal distribution, whose mean comes before it */
    char key[FIT_KEY_CAPACITY];   /* "targets[0].draw.length" */
};

/* What else a fitted campaign says. NaN, and limits of 0: as it was. */
struct fitted_selection {
    double highlight_db, shadow_db; /* visible */
    struct ratio_limits chip;       /* range over altitude */
    struct ratio_limits *swaths;    /* one each; NULL: they have none of their own */
};

/* The campaign must outlive it. Starts as all zeros; for fit_draws_clear. */
struct fit_draws {
    bool lacks_shadows;              /* contacts do: what nothing else shows stays */
    const struct campaign *campaign; /* borrowed */
    char *text;                      /* of its file; owned */
    struct fitted_number *numbers;   /* owned */
    size_t count;
    bool lacks_level[CAMPAIGN_ITEMS_MAX]; /* targets that do not draw theirs */
    bool lacks_floor;
    bool has_added;                /* what they lack, so far: */
    double level_db[2], floor_db;  /* between these, and this */
    struct growing_text unchanged; /* what is drawn of targets and stays, one a line; owned */
    struct growing_text fixed;     /* whose sizes have no such numbers, a clause; owned */
};

/* Lists the numbers of a campaign that fit can move. Errors: INPUT (levels by target strength, a
 * number that --set gives), STORAGE, MEMORY. */
sonject_status fit_draws_find(struct fit_draws *draws, struct report *report,
                              const struct campaign *campaign);
void fit_draws_clear(struct fit_draws *draws);

/* Moves all numbers, and what was added. */
void fit_draws_move(struct fit_draws *draws, const struct draw_move *moves);

/* The campaign's own text with the numbers as they are now in their places, comments and all.
 * comment: lines to put before it. *text is for free(). Errors: INPUT (a key cannot be added
 * there), MEMORY. */
sonject_status fit_draws_text(const struct fit_draws *draws, struct report *report,
                              const struct fitted_selection *selection, const char *comment,
                              char **text);

/* ---- The whole (fit.c), and its page (fit_page.c). */

#define FIT_CHIPS  104 /* in a round */
#define FIT_ROUNDS 8   /* the last one only shows what came of it */
#define FIT_SHOWN  20  /* chips on the page, of each kind */

/* All that the page tells. */
struct fit {
    struct report *report;
    struct campaign_source source; /* of the campaign that is fitted */
    char folder[PATH_CAPACITY];    /* where calibrations go that its scene asks for */
    struct contact_choice choice;
    struct sonject_campaign *campaign; /* as its file is */
    struct contact_set set;
    struct contact_extents *real; /* owned */
    size_t *swaths;               /* that show them; owned */
    size_t real_count;            /* that are measured; of quantiles 0 */
    struct quantile_goal goals[EXTENT_KINDS];
    struct drawn_contact *made; /* of all rounds; owned */
    size_t made_count;
    uint64_t pad; /* pixels by which labels of injected contacts are widened, to be as real ones */
    struct contact_chip real_chips[FIT_SHOWN], made_chips[FIT_SHOWN];
    size_t real_chip_count, made_chip_count;
    struct fit_draws draws;
    struct fitted_selection selection;
    struct growing_text notes; /* on the page, one a line; owned */
};

/* sonject_campaign_fit. Errors: as it says. */
sonject_status campaign_fit(struct report *report, struct device_slot *slot,
                            const struct campaign_source *source,
                            const sonject_campaign_fit_params *params,
                            sonject_progress_function progress, void *user);

/* The name of the fitted campaign's file with another extension, such as ".html". Errors: STORAGE
 * (it is too long). */
sonject_status fit_page_name(struct report *report, const char *fitted, const char *extension,
                             char path[PATH_CAPACITY]);

/* Writes the page, "<fitted without extension>.html", and its picture ".png". Errors: STORAGE,
 * MEMORY. */
sonject_status fit_page_write(const struct fit *fit, const char *fitted);

#endif
