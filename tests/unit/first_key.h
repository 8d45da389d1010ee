/* A listener of checks that keeps the key of the first failure. */
#ifndef FIRST_KEY_H
#define FIRST_KEY_H

#include <stdio.h>

#include "base/report.h"

struct first_key {
    struct check_listener listener; /* first */
    char key[128];                  /* "": there was no failure */
};

static inline void hear_first(struct check_listener *listener, const char *key, const char *others,
                              const char *what)
{
    struct first_key *first = (struct first_key *)listener;
    (void)others;
    (void)what;
    if (!*first->key)
        snprintf(first->key, sizeof first->key, "%s", key);
}

#define FIRST_KEY                                                                                  \
    {                                                                                              \
        {hear_first}, ""                                                                           \
    }

#endif
