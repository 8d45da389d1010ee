/* The version of the headers, and of the library that is loaded. */
#ifndef SONJECT_VERSION_H
#define SONJECT_VERSION_H

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

#define SONJECT_VERSION_MAJOR 0
#define SONJECT_VERSION_MINOR 1
#define SONJECT_VERSION_PATCH 0

/* Returns "major.minor.patch" of the loaded library; static storage. */
SONJECT_API const char *sonject_version(void);

SONJECT_END_DECLARATIONS

#endif
