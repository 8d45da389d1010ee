/* Windows wants its texts in UTF-16, and has errors of its own. */
#ifndef SONJECT_BASE_SYSTEM_WINDOWS_TEXT_H
#define SONJECT_BASE_SYSTEM_WINDOWS_TEXT_H

#include <wchar.h>

/* Between UTF-8 and UTF-16. To be given to free(); NULL with errno: memory is out (ENOMEM), or the
 * text is not of that coding (EINVAL). */
wchar_t *wide_text(const char *text);
char *narrow_text(const wchar_t *text);

/* The errno that says the same as the last error of this thread. */
int last_errno(void);

#endif
