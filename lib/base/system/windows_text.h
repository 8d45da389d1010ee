/* Windows' texts, which are UTF-16, and its errors. */
#ifndef SONJECT_BASE_SYSTEM_WINDOWS_TEXT_H
#define SONJECT_BASE_SYSTEM_WINDOWS_TEXT_H

#include <wchar.h>

/* Converts between UTF-8 and UTF-16. The result is for free(); NULL with errno: ENOMEM, or EINVAL
 * for text that is not in that coding. */
wchar_t *wide_text(const char *text);
char *narrow_text(const wchar_t *text);

/* Returns the errno that stands for this thread's last error. */
int last_errno(void);

#endif
