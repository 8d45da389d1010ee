/* Progress of a part of a call as a share of the whole call's. */
#ifndef SONJECT_BASE_PROGRESS_H
#define SONJECT_BASE_PROGRESS_H

#include <sonject/context.h>

/* The part's fractions 0 to 1 become first to first + share. */
struct progress_share {
    sonject_progress_function progress; /* the whole call's; may be NULL */
    void *user;
    double first, share;
};

/* A sonject_progress_function; user: the struct progress_share. */
int progress_share_tell(void *user, double fraction, const char *stage);

#endif
