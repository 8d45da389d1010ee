/* What compilers say about users' code. */
#ifndef SONJECT_USER_BUILD_LOG_H
#define SONJECT_USER_BUILD_LOG_H

#include "base/report.h"
#include "scene/user_shapes.h"

/* Makes "name:line: what" of the first error in a build log, where it lies in one of the snippets,
 * and else tells the error itself. Known are the forms "error: name:line:column: what" and
 * "name:line:column: error: what". The log's lines go to report's log. Returns INPUT. */
sonject_status explain_build_log(struct report *report, const struct user_shapes *shapes,
                                 const char *device_name, const char *log);

#endif
