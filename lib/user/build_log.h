/* What compilers say about users' code. */
#ifndef SONJECT_USER_BUILD_LOG_H
#define SONJECT_USER_BUILD_LOG_H

#include "user/snippet.h"

/* Makes "name:line: what" of the first error in the log of a snippet's unit. Known are the forms
 * "error: file:line:column: what" and "file:line:column: error: what"; else the error itself is
 * told. The log's lines go to report's log. Returns INPUT. */
sonject_status explain_build_log(struct report *report, const struct user_snippet *snippet,
                                 const char *device_name, const char *log);

#endif
