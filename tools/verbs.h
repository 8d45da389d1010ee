/* The verbs in the order of the help, a file each, which has the verb's name. The command's table,
 * what is compiled and the manual pages come from these rows. */
#ifndef SONJECT_TOOLS_VERBS_H
#define SONJECT_TOOLS_VERBS_H

#include "arguments.h"
#include "base/text.h"

#define VERBS(ROW)                                                                                 \
    ROW(init)                                                                                      \
    ROW(run)                                                                                       \
    ROW(trace)                                                                                     \
    ROW(form)                                                                                      \
    ROW(campaign)                                                                                  \
    ROW(fit)                                                                                       \
    ROW(merge)                                                                                     \
    ROW(check)                                                                                     \
    ROW(measure)                                                                                   \
    ROW(calibrate)                                                                                 \
    ROW(quicklook)                                                                                 \
    ROW(convert)                                                                                   \
    ROW(seabed)                                                                                    \
    ROW(elements)                                                                                  \
    ROW(devices)

#define VERB_DECLARATION(name) extern const struct verb name##_verb;
VERBS(VERB_DECLARATION)

/* sonject help KEY (key_help.c): prints the keys of that name, whichever their section, and all
 * below it; numbers in brackets do not matter. nearest: knows the verbs that may have been meant.
 * Gives the exit code. */
int key_help(const char *name, struct nearest *nearest);

#endif
