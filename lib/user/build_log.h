/* What compilers say about users' code. */
#ifndef SONJECT_USER_BUILD_LOG_H
#define SONJECT_USER_BUILD_LOG_H

#include "base/report.h"
#include "scene/user_shapes.h"

/* Users' code as a program holds it: before, code and behind of each snippet, one after another. */
struct user_text {
    const struct user_shapes *shapes;
    unsigned long lines_before; /* of the program, before the first snippet */
};

/* Makes "name:line: what" of the first error in a build log, where it lies in one of the snippets,
 * and else tells the error itself. Known are the forms "error: name:line:column: what" and
 * "name:line:column: error: what"; of compilers that leave #line out of account (NVIDIA's),
 * "<any name>:line:column: error: what" with lines of the whole program. The log's lines go to
 * report's log. Returns INPUT. */
sonject_status explain_build_log(struct report *report, const struct user_text *text,
                                 const char *device_name, const char *log);

#endif
