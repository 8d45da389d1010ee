/* The verbs in the order of the help. Each has a file of its name. The command's table, the
 * compiled files and the manual pages come from these rows. */
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

/* Prints, for sonject help KEY, the keys of that name in any section and all keys below them.
 * Indices in brackets are ignored. nearest: knows the similar verbs. Returns the exit code. */
int key_help(const char *name, struct nearest *nearest);

#endif
