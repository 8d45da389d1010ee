/* Compiled programs kept between runs. A damaged or foreign file is as good as none. */
#ifndef SONJECT_CL_CACHE_H
#define SONJECT_CL_CACHE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

/* The folder to use: `asked` if not NULL ("" means none), else sonject's in the user's cache. To be
 * given to free(); NULL: no cache. */
char *cache_folder_for(const char *asked);

/* Reads what was kept under the key (32 hexadecimal digits). *bytes is for free(). */
bool cache_read(const char *folder, const char *key, unsigned char **bytes, size_t *count);

/* Keeps bytes under the key. A failure is no failure of the caller's: the next run compiles anew.
 */
void cache_write(const char *folder, const char *key, const unsigned char *bytes, size_t count);

#endif
